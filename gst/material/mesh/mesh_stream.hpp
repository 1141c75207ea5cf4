// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

namespace inverse {

/// What inverse-read-mesh writes to its standard output, before the texts and arrays that it
/// counts: an error, a warning (bytes each), positions and normals (3 floats a vertex each),
/// indices (words).
struct MeshHeader {
  static constexpr uint32_t kMagic = 0x4853454d;  // "MESH"
  static constexpr uint32_t kMaxText = 1 << 16;
  uint32_t magic = kMagic, error = 0, warning = 0, vertices = 0, indices = 0;
};

}  // namespace inverse
