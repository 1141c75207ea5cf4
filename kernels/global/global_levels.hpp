// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <utility>

#include "global_intrinsic.hpp"
#include "kernels/intrinsic/intrinsic_levels.hpp"

namespace inverse {

/// The quality levels of globalintrinsic: that of the solve in it, at the cost of finding and
/// dividing out the tint of light more.
inline const QualityLevels<GlobalIntrinsic::Params>& global_levels() {
  constexpr size_t kMaxLevels = 16;
  constexpr double kTint = 0.4;  // in relation to the solve's costs
  static const auto quality_levels = []<size_t... k>(std::index_sequence<k...>) {
    const auto& solve = intrinsic_levels();
    QualityLevels<GlobalIntrinsic::Params> made{
        {{k < solve.levels.size() ? solve.levels[k].cost + kTint : 0,
          [](GlobalIntrinsic::Params& params) { intrinsic_levels().levels[k].set(params); }}...},
        solve.qualities};
    made.levels.resize(solve.levels.size());
    return made;
  }
  (std::make_index_sequence<kMaxLevels>());
  return quality_levels;
}

}  // namespace inverse
