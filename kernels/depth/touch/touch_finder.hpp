// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>

#include "kernels/camera/touch.hpp"
#include "kernels/depth/volume.hpp"
#include "kernels/depth_touch_background.spv.hpp"
#include "kernels/depth_touch_choose.spv.hpp"
#include "kernels/depth_touch_compare.spv.hpp"
#include "kernels/depth_touch_grow.spv.hpp"
#include "kernels/depth_touch_points.spv.hpp"

namespace inverse {

/// Finds what is in front of a remembered scene, and where it touches that (thesis, 4.5.1).
/// docs/reference/methods/volume.md, 7.
class TouchFinder {
 public:
  /// For frames of one size. Throws Error(out_of_memory).
  TouchFinder(const std::shared_ptr<gpu::Device>& device, Extent extent);

  struct Frame {
    Lens lens;
    gpu::BufferPtr pose;
    gpu::BufferPtr surface;  ///< Volume::Frame::surface
    gpu::BufferPtr layers;   ///< rgb: its reflectance
    gpu::BufferPtr found;    ///< Tracker::found; if the camera is lost, nothing is in front
  };
  /// Records finding both. `view` is that of the frame's pose.
  void record(gpu::Commands& commands, const Frame& frame, const Volume::View& view);
  /// Records taking the depth away, a scalar a pixel, of what is in front in that frame and reaches
  /// into the picture.
  void record_background(gpu::Commands& commands, const gpu::BufferPtr& depth) const;

  /// What was found, kResultBytes.
  const gpu::BufferPtr& result() const { return touch_; }
  static constexpr uint64_t kResultBytes =
      uint64_t{4 * sizeof(float)} * shaders::depth_touch_choose::TOUCH_RESULT;
  /// Reads it; empty: nothing is touched.
  static std::optional<Touch> read(const float* result);
  /// Of the pixels with a depth, the share that is in front.
  static float front(const float* result);

  /// A word a pixel (touch.glsl).
  const gpu::BufferPtr& kinds() const { return kinds_[0]; }

 private:
  Extent tiles() const;

  Extent extent_;
  gpu::Program<shaders::depth_touch_compare> compare_;
  gpu::Program<shaders::depth_touch_grow> grow_;
  gpu::Program<shaders::depth_touch_points> points_;
  gpu::Program<shaders::depth_touch_choose> choose_;
  gpu::Program<shaders::depth_touch_background> background_;
  std::array<gpu::BufferPtr, 2> kinds_;
  gpu::BufferPtr any_, sums_, touch_, arm_;
};

}  // namespace inverse
