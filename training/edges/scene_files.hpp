// SPDX-License-Identifier: LGPL-2.1-or-later
// Files of scenes with truth: width and height as 32-bit integers, then for every pixel ten 32-bit
// floats: input, reflectance and shading (RGB, linear light), and the mask.
#pragma once

#include <string>
#include <vector>

#include "scenes.hpp"

namespace inverse::training {

void save_scene(const Scene& scene, const std::string& path);

/// Throws std::runtime_error if the file is no scene.
Scene load_scene(const std::string& path);

/// The files `*.scene` of a directory, sorted.
std::vector<std::string> scene_files(const std::string& directory);

}  // namespace inverse::training
