// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <assimp/IOSystem.hpp>
#include <filesystem>
#include <memory>
#include <string>

namespace inverse {

/// The content of a mesh, or of a file that it names, of at most 512 MiB. `fault` as read_file.
std::string read_mesh(const std::string& path, std::string& fault);

/// Whether a file without links in its path is in a folder, or in one of those below.
bool is_within(const std::filesystem::path& folder, const std::filesystem::path& file);

/// The files of a mesh for Assimp, those that describe its shape: `content` as that of `mesh`,
/// which is not opened again, and others that are in its folder. Other files, and reading behind
/// the end of one, are exceptions.
std::unique_ptr<Assimp::IOSystem> mesh_system(const std::string& mesh, std::string content);

}  // namespace inverse
