#pragma once
#include <string>
#include <vector>

#include "inflated_normals.hpp"
#include "kernels/image/plane.hpp"

namespace inverse {

/// Normals of what a frame shows, from an image of at most 8192 x 8192 pixels.
class NormalMap {
 public:
  /// Reads a PNG of 8 or 16 bits a channel: RGB = xyz from −1 (code 0) to 1 (largest code), x
  /// right, y up, z to the camera. Where z is not above 0, the length is far from 1 or alpha is
  /// below a half, there is no normal. Throws Error(file), saying why. Where most lengths are not
  /// near 1, `warning` says so; it is empty otherwise.
  static NormalMap load(const std::string& path, std::string& warning);
  NormalMap(Extent extent, std::vector<Normal> normals);

  /// The normal at a place of the frame, 0…1 from the left and from the top, between the four
  /// nearest; z = 0 where there is none.
  Normal at(float x, float y) const;

 private:
  Extent extent_;
  std::vector<Normal> normals_;
};

}  // namespace inverse
