// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "global_intrinsic.hpp"
#include "kernels/intrinsic/intrinsic_levels.hpp"

namespace inverse {

/// The quality levels of globalintrinsic: that of the solve in it, at the cost of finding and
/// dividing out the tint of light more.
inline const QualityLevels<GlobalIntrinsic::Params>& global_levels() {
  constexpr double kTint = 0.4;  // in relation to the solve's costs
  static const auto quality_levels = [] {
    const auto& solve = intrinsic_levels();
    QualityLevels<GlobalIntrinsic::Params> made{.qualities = solve.qualities};
    for (const auto& level : solve.levels) made.levels.push_back({level.cost + kTint, level.set});
    return made;
  }();
  return quality_levels;
}

}  // namespace inverse
