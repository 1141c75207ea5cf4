// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gst/base/filter.hpp"
#include "kernels/camera/known_reflectance.hpp"
#include "kernels/camera/place_stroke.hpp"
#include "kernels/camera/touch.hpp"
#include "kernels/image/strokes/seen_strokes.hpp"

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

/// Whether this build remembers scenes (option `depth`).
extern const bool kHasScene;

/// The properties of SceneParams.
template <typename P>
PropertyTable<P> scene_properties() {
  if (!kHasScene) return {};
  return {
      flag<P>("scene::remember", &P::scene_memory,
              "Remember the reflectance of the scene where frames carry depth, and start and "
              "steady each frame by it; false = depth is ignored"),
      number<P>("scene::weight", &P::scene_weight, 0.f, 1e3f,
                "Weight of remembered reflectance; raise it against flicker, 0 = frames are only "
                "remembered"),
      flag<P>("scene::track", &P::scene_track,
              "Follow the camera by depth and brightness; false = frames are where the poses that "
              "come with them say"),
      flag<P>("scene::update", &P::scene_update,
              "Add frames to the remembered scene; false = it stays as it is, for a hand in it"),
      number<P>("scene::voxel-size", &P::voxel_size, 0.002f, 0.1f,
                "Side of a voxel of the remembered scene, meters; a change forgets it"),
      number<P>("scene::max-depth", &P::scene_depth, 0.3f, 50.f,
                "Distance from the camera up to which the scene is remembered, meters; a change "
                "forgets it"),
      number<P>("scene::memory-limit", &P::scene_memory_limit, 8, 65536,
                "Memory of the device for the remembered scene, MiB; the host keeps what is out of "
                "sight beyond it, up to 8 times as much; a change forgets the scene"),
      text<P>("scene::load", &P::scene_load,
              "File of a scene (.scene) that is known from the start; the camera is looked for in "
              "it",
              Mutable::ready),
      text<P>("scene::location", &P::scene_location,
              "File that the remembered scene is written to when the stream ends: .ply for a mesh "
              "with reflectance, .scene for scene::load"),
  };
}

/// What a decomposer does with frames that carry depth: it remembers the scene, before and after
/// its method decomposes a frame.
class SceneWork {
 public:
  virtual ~SceneWork() = default;
  virtual void configure(const std::shared_ptr<gpu::Device>& device) = 0;
  virtual void release() = 0;

  /// What is asked of the scene for a frame.
  struct Wanted {
    StrokesPtr strokes;      ///< those in the scene are drawn into it
    bool keep_view = false;  ///< `view` has its depth
    bool touch = false;      ///< look for what touches the scene
  };
  /// Before the method decomposes `frame`, as its frame `number`: what is known of it; null:
  /// nothing. Adds warnings about its depth.
  virtual const KnownReflectance* recall(FrameContext& frame, uint64_t number,
                                         const SceneParams& params, const Wanted& wanted) = 0;
  /// Where that frame sees strokes of the scene; null: nowhere.
  virtual const SeenStrokes* seen() const = 0;
  /// SceneMemory::view.
  virtual std::optional<SceneView> view(uint64_t number) const = 0;
  /// What a completed frame touches, if that was looked for.
  virtual std::optional<Touch> touch(uint64_t number) const = 0;
  /// Whether that frame is the first of another scene than the frame before.
  virtual bool began() const = 0;
  /// Strokes of a scene that was loaded, since the last call.
  virtual std::vector<Stroke> take_loaded() = 0;
  /// After the method. Layers that are sent on get what the frame sees of the scene.
  virtual void remember(FrameContext& frame) = 0;
  /// Forgets the scene at the next frame. From any thread.
  virtual void forget() = 0;
  /// Writes the scene to a file at the next frame or the end (save_scene). From any thread. Throws
  /// Error(output) if there is none, or the name is not one.
  virtual void save(const std::string& path) = 0;
  /// Whether the next frame is needed for that, even if it came before.
  virtual bool requested() const = 0;
  /// The stream ended, or the element stops: writes the files that were asked for and, once a
  /// stream, `location`, if that is not empty. Throws Error(output) if one of them cannot be
  /// written.
  virtual void ended(const std::string& location) = 0;
  /// Adds fields about a completed frame of the method that had depth.
  virtual void describe(GstStructure* stats, uint64_t number) const = 0;
};

/// Of a build that remembers no scenes: warns of frames with depth, and does nothing else.
std::unique_ptr<SceneWork> make_scene_work();

}  // namespace inverse
