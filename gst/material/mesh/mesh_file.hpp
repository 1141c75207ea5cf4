// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "kernels/material/raster/mesh.hpp"

namespace inverse {

/// Corners that a polygon of a mesh file has at most: Assimp cuts one into triangles in more than
/// the square of their number.
constexpr unsigned kMaxCorners = 1000;

/// Reads a mesh from an OBJ, PLY or glTF (.gltf, .glb) file, ready to be drawn: all its parts in
/// one, in triangles, with normals (if it has none: smooth, but for edges sharper than 66
/// degrees), in the middle and of radius 1. Materials and textures are ignored. Throws
/// Error(file), which names the file, if it cannot be read, is none of these, has no triangles,
/// more than Mesh::kMaxTriangles, a polygon of more than kMaxCorners corners, or more than 512 MiB,
/// or if it names a file outside of its folder. Faces whose corners do not exist or are no numbers
/// are left out; `warning` says so, or is empty.
Mesh parse_mesh(const std::string& path, std::string& warning);

}  // namespace inverse
