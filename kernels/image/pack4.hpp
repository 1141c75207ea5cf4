// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

#include "kernels/gpu/commands.hpp"
#include "plane.hpp"

namespace inverse {

/// Packs a row: the solver's planes hold four horizontally adjacent pixels in one vec4
/// (pack4.glsl).
constexpr uint32_t pack4_count(uint32_t width) { return (width + 3) / 4; }
/// Packs of a whole plane.
constexpr uint64_t pack4_count(Extent extent) {
  return static_cast<uint64_t>(pack4_count(extent.width)) * extent.height;
}
/// So many items, dispatched in one line (grid_position in pack4.glsl).
constexpr gpu::Items line_of(uint64_t items) { return {static_cast<uint32_t>(items)}; }

}  // namespace inverse
