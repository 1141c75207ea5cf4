// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <vector>

#include "kernels/depth/volume_data.hpp"
#include "keyframes.hpp"

namespace inverse {

/// A remembered scene, on the host.
struct SceneData {
  VolumeData volume;
  std::vector<Keyframes::Frame> keyframes;
  std::string strokes;  ///< in it, as the user of this class writes them
};

/// Writes a scene: as a mesh (ply_of) if the name ends in .ply, else as a file for `load_scene`,
/// which ends in .scene. Throws Error(output) if it ends in something else or cannot be written.
void save_scene(const SceneData& scene, const std::string& path);
/// Throws Error(output) if `save_scene` would not take the name, or its folder takes no files.
void check_scene_target(const std::string& path);

/// Reads such a file. Throws Error(file) if it is missing, damaged, of another version, or larger
/// than `max` bytes.
SceneData load_scene(const std::string& path, uint64_t max);

}  // namespace inverse
