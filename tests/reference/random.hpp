// SPDX-License-Identifier: LGPL-2.1-or-later
// The counter-based random numbers that references and shaders share bit by bit.
#pragma once

#include <array>
#include <cstdint>

namespace inverse::reference {

/// pcg3d of Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020: hashes three
/// 32-bit counters to three 32-bit numbers.
inline std::array<std::uint32_t, 3> pcg3d(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  x = x * 1664525u + 1013904223u;
  y = y * 1664525u + 1013904223u;
  z = z * 1664525u + 1013904223u;
  x += y * z;
  y += z * x;
  z += x * y;
  x ^= x >> 16;
  y ^= y >> 16;
  z ^= z >> 16;
  x += y * z;
  y += z * x;
  z += x * y;
  return {x, y, z};
}

/// The upper 16 bits of `random` mapped to 0 … count − 1, for count up to 65536.
inline std::uint32_t random_below(std::uint32_t random, std::uint32_t count) {
  return ((random >> 16) * count) >> 16;
}

}  // namespace inverse::reference
