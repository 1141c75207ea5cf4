// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstddef>

struct aiScene;

namespace inverse {

/// FaceCount of three corners and more that a scene had, and those of them that are no areas, as
/// corners do not exist or are no numbers.
struct FaceCount {
  size_t areas = 0, left_out = 0;
};

/// Leaves what is sound of a scene as it was read: the faces that are areas, the vertices that they
/// have, the meshes that have some. Assimp's later steps end the process on what its readers may
/// let through.
FaceCount sanitize(aiScene& scene);

}  // namespace inverse
