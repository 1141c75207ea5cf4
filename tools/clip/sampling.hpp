// SPDX-License-Identifier: LGPL-2.1-or-later
// Correlated multi-jittered sample points (A. Kensler, Pixar TM 13-01, 2013): stratified in two
// dimensions and in each alone, reproducible from a seed.
#pragma once

#include <cstdint>

#include "vec.hpp"

namespace inverse::clip {

struct Point2 {
  float u, v;
};

/// Pseudo-random permutation of 0…length-1 (Kensler's hash with cycle walking).
inline uint32_t permute(uint32_t i, uint32_t length, uint32_t seed) {
  uint32_t mask = length - 1;
  mask |= mask >> 1, mask |= mask >> 2, mask |= mask >> 4, mask |= mask >> 8, mask |= mask >> 16;
  do {
    i ^= seed, i *= 0xe170893d, i ^= seed >> 16, i ^= (i & mask) >> 4;
    i ^= seed >> 8, i *= 0x0929eb3f, i ^= seed >> 23, i ^= (i & mask) >> 1;
    i *= 1 | seed >> 27, i *= 0x6935fa69, i ^= (i & mask) >> 11, i *= 0x74dcb303;
    i ^= (i & mask) >> 2, i *= 0x9e501cc3, i ^= (i & mask) >> 2, i *= 0xc860a3df;
    i &= mask, i ^= i >> 5;
  } while (i >= length);
  return (i + seed) % length;
}

inline float random_float(uint32_t i, uint32_t seed) {
  i ^= seed, i ^= i >> 17, i ^= i >> 10, i *= 0xb36534e5, i ^= i >> 12, i ^= i >> 21;
  i *= 0x93fc4795, i ^= 0xdf6e307f, i ^= i >> 17, i *= 1 | seed >> 18;
  return static_cast<float>(i >> 8) * 0x1p-24f;
}

/// Point `s` of a columns × rows pattern in the unit square.
inline Point2 multi_jittered(uint32_t s, uint32_t columns, uint32_t rows, uint32_t seed) {
  s = permute(s, columns * rows, seed * 0x51633e2d);
  uint32_t column = s % columns, row = s / columns;
  uint32_t sub_x = permute(column, columns, seed * 0xa511e9b3);
  uint32_t sub_y = permute(row, rows, seed * 0x63d83595);
  float jitter_x = random_float(s, seed * 0xa399d265),
        jitter_y = random_float(s, seed * 0x711ad6a5);
  auto m = static_cast<float>(columns), n = static_cast<float>(rows);
  return {(static_cast<float>(column) + (static_cast<float>(sub_y) + jitter_x) / n) / m,
          (static_cast<float>(row) + (static_cast<float>(sub_x) + jitter_y) / m) / n};
}

/// Concentric map of the unit square to the unit disk (Shirley and Chiu 1997).
inline Point2 to_disk(Point2 p) {
  float a = 2 * p.u - 1, b = 2 * p.v - 1;
  if (a == 0 && b == 0) return {0, 0};
  bool wide = a * a > b * b;
  float radius = wide ? a : b;
  float angle = wide ? kPi / 4 * (b / a) : kPi / 2 - kPi / 4 * (a / b);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace inverse::clip
