#pragma once
#include <cstdint>

#include "kernels/gpu/commands.hpp"
#include "plane.hpp"

namespace inverse {

/// Quads a row: the solver's planes hold four horizontally adjacent pixels in one vec4 (quad.glsl).
constexpr uint32_t quads_of(uint32_t width) { return (width + 3) / 4; }
/// Quads of a whole plane.
constexpr uint64_t quads_of(Extent extent) {
  return static_cast<uint64_t>(quads_of(extent.width)) * extent.height;
}
/// So many items, dispatched in one line (grid_position in quad.glsl).
constexpr gpu::Items line_of(uint64_t items) { return {static_cast<uint32_t>(items)}; }

}  // namespace inverse
