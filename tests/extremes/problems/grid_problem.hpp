// SPDX-License-Identifier: LGPL-2.1-or-later
// Systems of intrinsicdecomp's multigrid (kernels/intrinsic/energy/energy.glsl) with any weights,
// which the edge prior bounds.
#pragma once
#include <vector>

#include "tests/extremes/support/problem.hpp"

namespace inverse::extremes {

/// Edges live with the pixel on their left or upper end; 0 if there is none. Cells of 4 × 4
/// pixels carry screen (mean s)² − 2 pull (mean s), and t of each of their pixels.
struct GridSystem {
  Extent extent, cells;
  std::vector<float> right, down, f;        ///< pixels
  std::vector<float> screen, pull, anchor;  ///< cells

  explicit GridSystem(Extent extent);
  size_t at(uint32_t x, uint32_t y) const { return static_cast<size_t>(y) * extent.width + x; }
  size_t cell(uint32_t x, uint32_t y) const {
    return static_cast<size_t>(y / 4) * cells.width + x / 4;
  }
};

/// Its matrix; the right-hand side is f plus every pixel's share of its cell's pull.
Eigen::MatrixXd matrix_of(const GridSystem& system);
std::vector<double> right_hand_side(const GridSystem& system);

/// The unknown after each of `cycles` cycles from zero, as the device's multigrid makes them with
/// its defaults; the last one where `last` is set.
std::vector<std::vector<double>> cycles_on_device(const Lab& lab, const GridSystem& system,
                                                  uint32_t cycles, bool last = true);

}  // namespace inverse::extremes
