// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "kernels/camera/known_reflectance.hpp"
#include "kernels/camera/place_stroke.hpp"
#include "kernels/camera/seen_scene.hpp"
#include "kernels/depth/streaming/host_blocks.hpp"
#include "kernels/depth/strokes/scene_strokes.hpp"
#include "kernels/depth/touch/touch_finder.hpp"
#include "kernels/depth/tracking/tracker.hpp"
#include "kernels/depth/volume.hpp"
#include "kernels/depth_memory_keep_found.spv.hpp"
#include "kernels/depth_memory_read_depth.spv.hpp"
#include "kernels/depth_memory_resize.spv.hpp"
#include "kernels/depth_memory_retry.spv.hpp"
#include "kernels/depth_memory_see.spv.hpp"
#include "kernels/depth_memory_thumbnail.spv.hpp"
#include "kernels/gpu/frame_ring.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/image/strokes/seen_strokes.hpp"
#include "keyframes.hpp"
#include "scene_file.hpp"

namespace inverse {

/// A scene that a depth camera walks through: it follows the camera, shows what is known of the
/// reflectance that a frame sees, and adds what was found of it (thesis, 4.4 and 4.6).
/// docs/reference/methods/volume.md. Not thread-safe.
class SceneMemory {
 public:
  struct Params {
    Volume::Params volume;
    Tracker::Params tracker;
    bool track = true;  ///< false: frames with a pose are where that says
    float weight = 1;   ///< KnownReflectance::weight
    /// Once it has `always` frames, only each `every`-th one is added: what most of a frame shows
    /// is known by then.
    uint32_t always = 8, every = 3;
    /// Frames that are added from one place; then none until the camera has moved by half a voxel
    /// or a quarter of a degree, or `matched` has changed by .05.
    uint32_t still = 24;
    /// Larger depth images are thinned out: voxels are coarser than their pixels.
    uint32_t max_width = 320;
    /// Frames that a lost camera is looked for at, and how many of them, by likeness.
    uint32_t keyframes = 256, candidates = 8;
  };
  /// A depth image that shows what the picture shows.
  struct Depth {
    const std::byte* rows;  ///< 16 bits a pixel, little endian; 0 and 65535: unknown
    size_t stride;          ///< bytes from row to row
    Extent extent;
    float unit;  ///< meters of a step
    Lens lens;
    std::optional<Pose> pose;  ///< without one the first frame is at Pose{}
  };

  /// `depth`: the size of depth images. Throws Error(limit) and Error(out_of_memory).
  SceneMemory(const std::shared_ptr<gpu::Device>& device, Extent depth, const Params& params);

  /// Records following the camera to frame `number` and showing what is known of it. Empty: nothing
  /// is. The planes are valid until the next call; frame number - kFramesInFlight must be done.
  std::optional<KnownReflectance> record_recall(gpu::Commands& commands, uint64_t number,
                                                const Depth& depth, const Plane& picture);
  /// Records adding the reflectance of that frame's layers (R.rgb, S).
  void record_remember(gpu::Commands& commands, const Plane& layers);
  /// Records what that frame sees of the scene, after `record_remember`; null: nothing is known.
  std::shared_ptr<const SeenScene> record_seen(gpu::Commands& commands);

  /// All that is remembered, of frames whose commands are submitted; waits for the device.
  SceneData data();
  /// Remembers that instead, before the first frame: the camera is looked for in it. Throws
  /// Volume::restore's errors.
  void restore(const SceneData& scene);

  /// What was before the next frame is another part of the stream: the camera is looked for in the
  /// scene. False: nothing of it is known yet, so begin anew.
  bool look_for_camera();

  /// Strokes, of which those in the scene are drawn into it; null: none.
  void set_strokes(const StrokesPtr& strokes);
  /// Of the frame of the last `record_recall`: where it sees them. Empty: no stroke is in the
  /// scene, or nothing is known yet.
  std::optional<SeenStrokes> seen_strokes() const;
  /// What the camera of a completed frame saw, as `findings`; without depth unless `keeps_views`
  /// was set for it. Empty: the camera was not found.
  std::optional<SceneView> view(uint64_t number) const;
  void keep_views(bool keeps) { keeps_views_ = keeps; }

  /// Whether frames are added, from the next one on. Without any the scene stays unknown.
  void set_update(bool updates) { updates_ = updates; }
  /// Whether frames were added, or a scene was restored.
  bool known() const { return added_ > 0; }
  /// Whether it looks for what is in front of the scene and touches it, from the next frame on;
  /// what is in front is then not added.
  void set_touch(bool touches);
  /// What a completed frame touches, as `findings`; empty: nothing, or it was not looked for.
  std::optional<Touch> touch(uint64_t number) const;
  /// Of the last frame for which that was looked for: a word a pixel of what is worked on
  /// (touch.glsl); null: there was none.
  gpu::BufferPtr touch_kinds() const { return touch_ ? touch_->kinds() : nullptr; }

  /// Of depth images.
  Extent depth_extent() const { return depth_extent_; }
  void set_weight(float weight) { params_.weight = weight; }

  /// What the device found of a frame.
  struct Findings {
    bool found = true;            ///< the camera; false: the frame was not added
    uint32_t frames_lost = 0;     ///< up to this one, in a row
    float rms = 0;                ///< distance of matched points, meters
    float matched = 1;            ///< share of the depth image that is where it was expected
    uint32_t blocks = 0;          ///< of 8 x 8 x 8 voxels that there are
    uint32_t blocks_visible = 0;  ///< of which the frame saw
    uint32_t blocks_host = 0;     ///< of which there is no copy on the device
    uint32_t blocks_refused = 0;  ///< for which the frame found no memory
    uint32_t blocks_outside = 0;  ///< too far from where the camera began
    uint32_t keyframes = 0;       ///< so far
    bool view_kept = false;       ///< what is known was not rendered anew: nothing had changed
    bool added = false;           ///< it was to be added; it was not if the camera was not found
    std::optional<float> front;   ///< share of known depth in front of the scene, if looked for
  };
  /// Of one of the last kFramesInFlight frames, once its Commands have been waited for; empty: it
  /// was not shown to this memory.
  std::optional<Findings> findings(uint64_t number) const;

 private:
  const gpu::BufferPtr& resized(gpu::Commands& commands, const Plane& plane);
  void read(gpu::Commands& commands, uint64_t number, const Depth& depth);
  /// Whether the camera was at `still_` in a frame that was found there.
  bool stands(const Pose& pose, float matched) const;
  /// Learns from frame `number` - kFramesInFlight, if there is one: a keyframe; or, if the camera
  /// was lost, where it may be.
  std::optional<Pose> learn(uint64_t number);
  /// The pose on the device, in what frame `number` has of its own.
  const gpu::BufferPtr& upload(uint64_t number, const Pose& pose);

  Params params_;
  Extent depth_extent_;
  uint32_t step_;  // pixels of a depth image from one that is used to the next
  Extent extent_;  // of what is worked on
  Lens lens_;
  Volume volume_;
  Tracker tracker_;
  Volume::View view_;
  gpu::Program<shaders::depth_memory_read_depth> read_depth_;
  gpu::Program<shaders::depth_memory_keep_found> keep_found_;
  gpu::Program<shaders::depth_memory_resize> resize_;
  gpu::Program<shaders::depth_memory_retry> retry_;
  gpu::Program<shaders::depth_memory_thumbnail> thumbnail_;
  gpu::Program<shaders::depth_memory_see> see_;
  PlanePool surfaces_, poses_;
  gpu::BufferPtr depth_, kept_depth_, stroke_ids_, resized_, certain_, thumbnail_plane_;
  gpu::BufferPtr lit_;  // layers of the frame before; null: there was none
  struct InFlight {
    gpu::BufferPtr image, pose, found, depth;
    bool has_depth = false;  // of the view
    bool added = false;
    bool touches = false;  // touch was looked for
    uint32_t blocks_host = 0;
    Lens lens;
    std::optional<uint64_t> number;  // of the frame, once it is recorded
  };
  gpu::FrameRing<InFlight> frames_;
  std::shared_ptr<gpu::Device> device_;
  uint64_t number_ = 0;
  uint32_t added_ = 0;  // frames
  struct Still {
    Pose pose;
    float matched = 0;
    uint32_t added = 0;  // frames from there
  };
  Still still_;
  uint64_t next_ = 0;     // frame to be added
  bool tracked_ = false;  // this frame
  Keyframes keyframes_;
  HostBlocks host_blocks_;
  std::optional<HostBlocks::Known> last_known_;
  uint64_t stroke_lists_ = 0;            // so far
  std::optional<SceneStrokes> strokes_;  // made for the first one in the scene
  StrokesPtr stroke_list_;
  std::optional<TouchFinder> touch_;  // made when it is first looked for
  bool updates_ = true, touches_ = false;
  bool keeps_views_ = false;
  bool searches_ = false;  // for the camera, in the next frame
  bool viewed_ = false;    // this frame
  uint32_t tries_ = 0;     // frames since the camera was lost, in a row
};

}  // namespace inverse
