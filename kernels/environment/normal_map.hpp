// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <vector>

#include "inflated_normals.hpp"
#include "png_pixels.hpp"

namespace inverse {

/// Normals for the content of a frame, from an image of at most 8192 x 8192 pixels.
class NormalMap {
 public:
  /// Reads a PNG of 8 or 16 bits per channel: RGB = xyz from −1 (code 0) to 1 (largest code), x
  /// right, y up, z to the camera. There is no normal if z ≤ 0, the length is far from 1, or alpha
  /// is below a half. Throws Error(file) with the cause. `warning` is set if most lengths are not
  /// near 1, else empty.
  static NormalMap load(const std::string& path, std::string& warning);
  /// The same of a file that was read.
  static NormalMap from(const PngPixels& png, const std::string& path, std::string& warning);
  NormalMap(Extent extent, std::vector<Normal> normals);

  /// The normal at a position of the frame, 0…1 from the left and from the top, interpolated
  /// between the nearest four; z = 0 if there is none.
  Normal at(float x, float y) const;

 private:
  Extent extent_;
  std::vector<Normal> normals_;
};

}  // namespace inverse
