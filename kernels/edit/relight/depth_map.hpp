// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <vector>

#include "kernels/environment/png_pixels.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// What a pixel sees: unit normal (x right, y down, z to the viewer) and depth in meters; depth 0:
/// unknown.
using SurfacePixel = std::array<float, 4>;

/// Depth of a still scene along the optical axis.
class DepthMap {
 public:
  /// From a gray PNG; code 0 is no depth. Holes are filled from around them. Throws Error(file) if
  /// nothing has depth; `path` is for the message.
  DepthMap(const PngPixels& png, const std::string& path);
  /// From codes, row by row.
  DepthMap(Extent extent, std::vector<float> codes);

  /// Surface of each pixel of a frame that the map covers. `focal_length`: of the frame, pixels;
  /// `units`: codes a meter. A normal is that of the plane that fits the inverse depth of a window
  /// of 5 x 5 best, which is exact for planes. Neighbors beyond an edge do not count.
  std::vector<SurfacePixel> surface(Extent frame, float focal_length, float units) const;

  /// Median of the codes that were not filled in.
  float median() const { return median_; }

 private:
  std::vector<SurfacePixel> own_surface(Extent frame, float focal_length, float units) const;

  Extent extent_;
  std::vector<float> codes_;
  float median_ = 0;
};

}  // namespace inverse
