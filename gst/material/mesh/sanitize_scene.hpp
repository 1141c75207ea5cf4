// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>

struct aiScene;

namespace inverse {

/// Faces of three corners or more, and those of them that were dropped because corners are missing
/// or not finite.
struct FaceCount {
  size_t areas = 0, dropped = 0;
};

/// Removes faces without an area, vertices without a face and meshes without a vertex from a scene
/// as Assimp read it. Assimp's later steps may end the process on such input.
FaceCount sanitize(aiScene& scene);

}  // namespace inverse
