// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <bit>
#include <cstdint>

namespace inverse {

/// Rounds to the nearest half float; NaN and negative values become 0, values beyond the range the
/// largest half float.
inline uint16_t to_half(float value) {
  if (!(value > 0)) return 0;
  if (value >= 65504) return 0x7bff;
  if (value < 0x1p-14F)  // subnormal: multiples of 2^-24, ties to even
    return static_cast<uint16_t>(std::bit_cast<uint32_t>(value + 0.5F) - 0x3f000000U);
  uint32_t bits = std::bit_cast<uint32_t>(value) - (uint32_t{112} << 23);
  bits += 0xfff + ((bits >> 13) & 1);
  return static_cast<uint16_t>(bits >> 13);
}

}  // namespace inverse
