// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace inverse {

/// The blocks of a volume, on the host (blocks.glsl, voxel.glsl).
struct VolumeData {
  static constexpr size_t kBlockVoxels = 512;
  static constexpr uint32_t kNoBlock = 0xffffffff;  ///< in place of a key
  float voxel = 0;                                  ///< side of one, meters
  float truncation = 0;                             ///< of distances, voxels
  std::vector<uint32_t> keys;                       ///< of every block
  std::vector<uint32_t> voxels;                     ///< kBlockVoxels a block
  std::vector<uint32_t> colors;                     ///< twice as many

  /// Coordinates of a block, in blocks.
  static std::array<int, 3> block_of(uint32_t key) {
    return {static_cast<int>(key & 2047) - 1024, static_cast<int>(key >> 22) - 512,
            static_cast<int>(key >> 11 & 2047) - 1024};
  }
  static uint32_t key_of(const std::array<int, 3>& block) {
    return static_cast<uint32_t>(block[0] + 1024) | static_cast<uint32_t>(block[2] + 1024) << 11 |
           static_cast<uint32_t>(block[1] + 512) << 22;
  }
  /// Of a voxel's word, in units of the truncation; its weight, 0: never seen.
  static float distance_of(uint32_t word) {
    return static_cast<float>(static_cast<int16_t>(word & 0xffff)) / 32767.0F;
  }
  static uint32_t weight_of(uint32_t word) { return word >> 16 & 255; }
};

}  // namespace inverse
