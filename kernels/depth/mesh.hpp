// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "volume_data.hpp"

namespace inverse {

/// The surfaces of a volume as triangles.
struct SceneMesh {
  struct Vertex {
    std::array<float, 3> place, normal;  ///< meters; unit, toward where the camera was
    std::array<float, 3> reflectance;    ///< linear RGB
  };
  std::vector<Vertex> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;  ///< counterclockwise from outside
};

/// Surface nets (Gibson 1998): a vertex in every cell of eight seen voxels in which the distance
/// changes its sign, at the mean of where it is zero along the cell's edges.
SceneMesh mesh_of(const VolumeData& data);

/// A binary PLY file: place, normal, and reflectance as sRGB of 8 bits, whose full scale is the
/// largest value that 1 % of the vertices exceed, or 1.
std::string ply_of(const SceneMesh& mesh);

}  // namespace inverse
