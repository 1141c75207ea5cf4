// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "environment.hpp"

namespace inverse {

/// An environment map prepared for shading: the light of cells of the sphere, for diffuse shading,
/// and a pyramid of the map, each level blurred to twice the width of the one below, for glossy
/// shading without sparkle.
struct PrefilteredLight {
  static constexpr uint32_t kCellRows = 16;  ///< cells: 16 x 32
  static constexpr uint32_t kMaxRows = 128;  ///< of the finest level
  static constexpr uint32_t kMinRows = 4;    ///< of the coarsest

  explicit PrefilteredLight(const Environment& environment);

  using Vec4 = std::array<float, 4>;
  /// Two entries per cell: its flux ∫ E dw (rgb), and its mean direction weighted by luminance. The
  /// direction is not normalized, so that a cell entirely above the horizon is exact.
  std::vector<Vec4> cells;
  uint32_t rows = 0;         ///< of level 0, a power of two; columns are twice as many
  uint32_t levels = 0;       ///< level l has rows >> l
  std::vector<Vec4> texels;  ///< rgb of all levels, one after the other
};

}  // namespace inverse
