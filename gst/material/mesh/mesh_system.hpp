// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <assimp/IOSystem.hpp>
#include <memory>
#include <string>

namespace inverse {

/// Why a file is not read, be it a mesh or one that it names; empty if it may be.
std::string why_no_mesh(const std::string& path);
/// The files of a mesh for Assimp: those that describe its shape, of
/// at most 1 GiB, no pipes. A file that ends too early is an exception.
std::unique_ptr<Assimp::IOSystem> mesh_system(const std::string& mesh);

}  // namespace inverse
