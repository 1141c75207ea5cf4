// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "kernels/material/raster/mesh.hpp"

namespace inverse {

/// The program that reads meshes: inverse-read-mesh, beside the plugin.
std::string mesh_reader();

/// parse_mesh (mesh_file.hpp) in a process of its own, which may take a minute of a processor and
/// 4 GiB: a fault of Assimp with a damaged file ends that process. Throws as parse_mesh, and
/// Error(file) if the reader does not end well.
Mesh load_mesh(const std::string& path, std::string& warning,
               const std::string& reader = mesh_reader());

}  // namespace inverse
