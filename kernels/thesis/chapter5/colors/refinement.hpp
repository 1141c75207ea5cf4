// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <span>
#include <vector>

namespace inverse {

/// The changes Δb_k of the base colors that minimize (5.14), chromaticity linearized at the present
/// colors. `sums` are the device's outer products, four floats an entry: the rgb of entry k + K l
/// is Σ_x R² T_k T_l for l ≤ k, that of entry k + K K is Σ_x R T_k e. `colors` are the K present
/// base colors, `initial` the estimated ones, to which the weight of chromaticity refers. The dense
/// 3K × 3K system is solved by singular value decomposition (5.7.1) in double precision;
/// undetermined directions do not change.
std::vector<std::array<float, 3>> solve_refinement(std::span<const float> sums,
                                                   std::span<const std::array<float, 3>> colors,
                                                   std::span<const std::array<float, 3>> initial,
                                                   double lambda_data, double lambda_ir,
                                                   double lambda_cr);

}  // namespace inverse
