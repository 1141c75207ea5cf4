// SPDX-License-Identifier: LGPL-2.1-or-later
// Which part of an object every subpixel of a perspective camera sees.
#pragma once

#include <vector>

#include "grid.hpp"

namespace inverse::lime {

/// A camera at the origin looking along −z, x right, y up. Image x runs right, y down; units are
/// subpixels.
struct Camera {
  float focal, center_x, center_y;
  /// Unit direction from the seen point toward the camera, for a subpixel's center.
  Vec view(int column, int row) const {
    return normalize(
        {-(float(column) + 0.5f - center_x) / focal, (float(row) + 0.5f - center_y) / focal, 1});
  }
};

struct Pose {
  Rotation turn;
  float scale;
  Vec position;  ///< z < −scale: in front of the camera.
};

/// Inverse depth (0: nothing there) and interpolated normal, not of unit length, of every subpixel.
class Raster {
 public:
  Raster(int size)
      : size_(size), near_(std::size_t(size * size)), normals_(std::size_t(size * size)) {}
  void draw(const Grid& grid, const Pose& pose, const Camera& camera);
  int size() const { return size_; }
  bool covered(int column, int row) const { return near_[index(column, row)] > 0; }
  const Vec& normal(int column, int row) const { return normals_[index(column, row)]; }

 private:
  std::size_t index(int column, int row) const { return std::size_t(row * size_ + column); }
  int size_;
  std::vector<float> near_;
  std::vector<Vec> normals_;
};

}  // namespace inverse::lime
