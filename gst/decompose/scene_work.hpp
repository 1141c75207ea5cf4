// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "gst/base/filter.hpp"
#include "kernels/volume/memory/scene_memory.hpp"

namespace inverse {

/// What users set of the memory of a scene that a depth camera sees.
struct SceneParams {
  bool scene_memory = true;
  float scene_weight = 1;   ///< KnownReflectance::weight
  bool scene_track = true;  ///< SceneMemory::Params::track
  bool scene_update = true;
  float voxel_size = 0.01F;      ///< meters
  float scene_depth = 5;         ///< meters from the camera that are remembered
  int scene_memory_limit = 192;  ///< MiB
  std::string scene_load, scene_location;
};

/// The properties of SceneParams.
template <typename P>
PropertyTable<P> scene_properties() {
  return {
      flag<P>("scene-memory", &P::scene_memory,
              "Remember the reflectance of the scene where frames carry depth, and start and "
              "steady each frame by it; false = depth is ignored"),
      number<P>("scene-weight", &P::scene_weight, 0.f, 1e3f,
                "Weight of remembered reflectance; raise it against flicker, 0 = frames are only "
                "remembered"),
      flag<P>("scene-track", &P::scene_track,
              "Follow the camera by depth and brightness; false = frames are where the poses that "
              "come with them say"),
      flag<P>("scene-update", &P::scene_update,
              "Add frames to the remembered scene; false = it stays as it is, for a hand in it"),
      number<P>("voxel-size", &P::voxel_size, 0.002f, 0.1f,
                "Side of a voxel of the remembered scene, meters; a change forgets it"),
      number<P>("scene-depth", &P::scene_depth, 0.3f, 50.f,
                "Distance from the camera up to which the scene is remembered, meters; a change "
                "forgets it"),
      number<P>("scene-memory-limit", &P::scene_memory_limit, 8, 65536,
                "Memory of the device for the remembered scene, MiB; the host keeps what is out of "
                "sight beyond it, up to 8 times as much; a change forgets the scene"),
      text<P>("scene-load", &P::scene_load,
              "File of a scene (.scene) that is known from the start; the camera is looked for in "
              "it",
              Mutable::ready),
      text<P>("scene-location", &P::scene_location,
              "File that the remembered scene is written to when the stream ends: .ply for a mesh "
              "with reflectance, .scene for scene-load"),
  };
}

/// What a decomposer does with frames that carry depth: it remembers the scene, before and after
/// its method decomposes a frame.
class SceneWork {
 public:
  void configure(const std::shared_ptr<gpu::Device>& device) { device_ = device; }
  void release();

  /// What is asked of the scene for a frame.
  struct Wanted {
    StrokesPtr strokes;      ///< those in the scene are drawn into it
    bool keep_view = false;  ///< `view` has its depth
    bool touch = false;      ///< look for what touches the scene
  };
  /// Before the method decomposes `frame`, as its frame `number`: what is known of it; null:
  /// nothing. Adds warnings about its depth.
  const KnownReflectance* recall(FrameContext& frame, uint64_t number, const SceneParams& params,
                                 const Wanted& wanted);
  /// Where that frame sees strokes of the scene; null: nowhere.
  const SeenStrokes* seen() const { return seen_ ? &*seen_ : nullptr; }
  /// SceneMemory::view.
  std::optional<SceneView> view(uint64_t number) const {
    return memory_ ? memory_->view(number) : std::nullopt;
  }
  /// What a completed frame touches, if that was looked for.
  std::optional<Touch> touch(uint64_t number) const {
    return memory_ ? memory_->touch(number) : std::nullopt;
  }
  /// Whether that frame is the first of another scene than the frame before.
  bool began() const { return began_; }
  /// Strokes of a scene that was loaded, since the last call.
  std::vector<Stroke> take_loaded() { return std::exchange(loaded_, {}); }
  /// After the method. Layers that are sent on get what the frame sees of the scene.
  void remember(FrameContext& frame);
  /// Forgets the scene at the next frame. From any thread.
  void forget() { forgets_ = true; }
  /// Writes the scene to a file at the next frame or the end (save_scene). From any thread. Throws
  /// Error(output) if there is none, or the name is not one.
  void save(const std::string& path);
  /// Whether the next frame is needed for that, even if it came before.
  bool requested() const;
  /// The stream ended: writes it to `location`, if that is not empty. Throws as save_scene.
  void ended(const std::string& location);
  /// Adds fields about a completed frame of the method that had depth.
  void describe(GstStructure* stats, uint64_t number) const;

 private:
  /// A depth image that is mapped while this lives.
  class Image;

  /// Forgets the scene.
  void reset();
  /// Adds a warning that was not given since the last reset.
  void warn(FrameContext& frame, const std::string& text);
  void warn_of(FrameContext& frame, const SceneMemory::Findings& found);
  /// Reads a scene into the memory; a warning if it cannot.
  void load(FrameContext& frame, const std::string& path);
  /// The scene with its strokes, for a file.
  SceneData data();
  /// Writes the files that were asked for.
  void write_wanted(FrameContext& frame);
  /// Makes the memory for frames like this one; false, with a warning, if it cannot.
  bool begin(FrameContext& frame, const SceneMemory::Depth& depth, const SceneParams& params);

  std::shared_ptr<gpu::Device> device_;
  std::optional<SceneMemory> memory_;
  SceneParams made_with_;
  std::optional<KnownReflectance> known_;
  std::optional<SeenStrokes> seen_;
  StrokesPtr strokes_;          // all of the last frame
  std::vector<Stroke> loaded_;  // from a file
  bool remembers_ = false;      // this frame
  bool began_ = false;
  std::set<std::string> told_;
  bool written_ = false;  // since the last frame
  std::atomic<bool> has_scene_ = false, forgets_ = false;
  mutable std::mutex mutex_;
  std::vector<std::string> wanted_;  // files
};

/// The action signals of a decomposer whose method has DecompositionMethod::scene: those of
/// strokes, save-scene and forget-scene.
std::vector<Action> scene_actions();

}  // namespace inverse
