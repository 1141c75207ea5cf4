// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>

#include "kernels/depth/volume.hpp"
#include "kernels/depth_smooth.spv.hpp"
#include "kernels/depth_tracking_agree.spv.hpp"
#include "kernels/depth_tracking_align.spv.hpp"
#include "kernels/depth_tracking_appearance.spv.hpp"
#include "kernels/depth_tracking_brightness.spv.hpp"
#include "kernels/depth_tracking_halve.spv.hpp"
#include "kernels/depth_tracking_move.spv.hpp"
#include "kernels/depth_tracking_predict.spv.hpp"

namespace inverse {

/// Follows a camera: brings each frame onto a view of the volume by iterated closest points with
/// projective association (Newcombe et al. 2011), coarse to fine, with differences of brightness
/// where geometry alone would slide. docs/reference/methods/volume.md.
class Tracker {
 public:
  struct Params {
    std::array<uint32_t, 3> steps{2, 4, 6};                 ///< at full, half and quarter size
    std::array<float, 3> max_distance{0.05F, 0.1F, 0.15F};  ///< of points that match, meters
    float min_cosine = 0.8F;                                ///< of the angle between their normals
    /// Meters that a difference of 1 in ln brightness is worth, as max_distance; 0: not used. At
    /// quarter size print that repeats would draw the camera to the wrong repetition.
    std::array<float, 3> photometric{0.03F, 0.03F, 0};
    float damping = 1e-5F;    ///< of a step, per m² and rad²
    float min_share = 0.35F;  ///< of pixels with a depth that must match
    /// The same if the camera was lost: other places may look a little alike.
    float lost_share = 0.5F;
    /// Then the frame must look like the view as well: the correlation of steps of ln brightness at
    /// a quarter of the size, unless their root mean square in the frame is below `plain`.
    float min_alike = 0.42F, plain = 0.03F;  // chosen on rooms of other seeds
    float max_rms = 0.03F;                   ///< of the distances of matched points, meters
  };

  /// For frames of one size. Throws Error(limit) and Error(out_of_memory).
  Tracker(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the levels of a frame, smoothed: `depth`, a scalar a pixel, meters, 0 where unknown;
  /// `picture`, linear RGB.
  void record_frame(gpu::Commands& commands, const Lens& lens, const gpu::BufferPtr& depth,
                    const gpu::BufferPtr& picture);
  /// That frame at a quarter of its size: ln brightness and depth, a scalar a pixel.
  struct Small {
    Extent extent;
    gpu::BufferPtr brightness, depth;
  };
  Small small() const { return {frame_[2].extent, frame_[2].brightness, frame_[2].depth}; }
  /// Normal and depth of that frame, as Volume::Frame::surface.
  const gpu::BufferPtr& surface() const { return frame_[0].surface; }

  /// Records what the next frames are brought onto: a view (depth, normals, reflectance) of the
  /// size and with the lens of the last frame, under the light that `layers` have (R.rgb, S) of
  /// that frame.
  void record_target(gpu::Commands& commands, const Volume::View& view,
                     const gpu::BufferPtr& layers);
  /// Records moving pose() to where the frame matches the target, from where it is if the motion
  /// between the last two frames, if both were found, goes on.
  void record_align(gpu::Commands& commands, const Params& params);

  /// Records that the camera of the next target is at `pose`, two vec4 (Pose): that of the first.
  void record_pose(gpu::Commands& commands, const gpu::BufferPtr& pose);
  /// Records that it is lost.
  void record_lost(gpu::Commands& commands);

  /// Two vec4 (Pose).
  const gpu::BufferPtr& pose() const { return pose_; }
  /// tracking.glsl.
  const gpu::BufferPtr& found() const { return found_; }

 private:
  struct Level {
    Extent extent;
    Lens lens;
    gpu::BufferPtr depth, surface, brightness;
  };

  gpu::Program<shaders::depth_smooth> smooth_;
  gpu::Program<shaders::depth_tracking_halve> halve_;
  gpu::Program<shaders::depth_normals> normals_;
  gpu::Program<shaders::depth_tracking_brightness> brightness_;
  gpu::Program<shaders::depth_tracking_appearance> appearance_;
  gpu::Program<shaders::depth_tracking_align> align_, align_geometry_;
  gpu::Program<shaders::depth_tracking_move> move_;
  gpu::Program<shaders::depth_tracking_agree> agree_;
  gpu::Program<shaders::depth_tracking_predict> predict_;
  using Levels = std::array<Level, 3>;
  void record_normals(gpu::Commands& commands, const Level& level) const;
  void record_coarser(gpu::Commands& commands, const Levels& levels) const;
  /// Records how alike the frame and the target look, if the camera was lost.
  void record_agreement(gpu::Commands& commands, const Params& params);
  Levels frame_, target_;
  gpu::BufferPtr pose_, target_pose_, start_, before_, found_, sums_;
  gpu::BufferPtr agreement_, lost_;
};

}  // namespace inverse
