// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/depth/strokes (thesis, 4.5) and of image/strokes/project.comp.
#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "tests/reference/camera/volume.hpp"

namespace inverse::reference {

/// A voxel that was seen.
struct MarkedVoxel {
  double distance = 1;  ///< truncations
  Vec3 color{};         ///< ln reflectance
  bool colored = false;
  uint32_t stroke = 0;  ///< id
};
/// By the grid coordinates of voxels.
using MarkedVoxels = std::map<Cell, MarkedVoxel>;

struct SceneStroke {
  std::vector<Vec4> balls;  ///< center and radius, meters
  bool fill = false;
  uint32_t id = 0;
};

/// Marks voxels within the truncation that are in a ball; later strokes cover earlier ones. Then
/// those that fill extend, in turn, to all colored voxels without a mark that are connected to them
/// by 26 neighbors and whose R is within .1 of the mean under their brush, and within a factor
/// of 1.5.
void mark(MarkedVoxels& voxels, double voxel, const std::vector<SceneStroke>& strokes);

/// A mask's number and half of the weight at a place of the image of `ids` (pixels; centers at
/// whole numbers): the nearest id, and (2 s - 1)² of its share s under a tent 4 pixels across; 0
/// where the surface is another.
double seen_stroke(const std::vector<uint32_t>& ids, const std::vector<double>& known_depth,
                   const std::vector<double>& depth, int width, int height,
                   const std::vector<uint32_t>& numbers, double x, double y);

}  // namespace inverse::reference
