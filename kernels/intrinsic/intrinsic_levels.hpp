// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/quality_levels.hpp"
#include "scaled_intrinsic.hpp"

namespace inverse {

/// A level: resolution, cycles of the first frame and of those after it, two tolerances, and which
/// network prior=learned is.
template <size_t kHalvings, uint32_t kCycles, uint32_t kWarm, float kEdgeTolerance,
          float kCycleTolerance, PriorWidth kPrior>
void intrinsic_level(ScaledIntrinsic::Params& params) {
  params.set_halvings(kHalvings);
  params.cycles = kCycles;
  params.warm_cycles = kWarm;
  params.tolerances.edge = kEdgeTolerance;
  params.tolerances.cycle = kCycleTolerance;
  params.prior_width = kPrior;
}

/// The levels of intrinsicdecomp (docs/reference/methods/intrinsicdecomp.md, 12).
inline const QualityLevels<ScaledIntrinsic::Params>& intrinsic_levels() {
  constexpr PriorWidth kMedium = PriorWidth::medium;
  static const QualityLevels<ScaledIntrinsic::Params> quality_levels{
      {{0.37, intrinsic_level<2, 2, 1, 0.1F, 0.01F, kMedium>},
       {0.46, intrinsic_level<1, 3, 1, 0.1F, 0.01F, kMedium>},
       {0.52, intrinsic_level<1, 4, 2, 0.1F, 0.01F, kMedium>},
       {0.53, intrinsic_level<1, 4, 2, 0.05F, 0.01F, kMedium>},
       {0.61, intrinsic_level<1, 8, 4, 0.05F, 0.003F, kMedium>},
       {0.98, intrinsic_level<0, 4, 2, 0.1F, 0.01F, kMedium>},
       {1.00, intrinsic_level<0, 4, 2, 0.05F, 0.01F, kMedium>},
       {1.26, intrinsic_level<0, 8, 4, 0.05F, 0.01F, kMedium>},
       {1.27, intrinsic_level<0, 8, 4, 0.05F, 0.003F, kMedium>},
       {1.48, intrinsic_level<0, 12, 8, 0.05F, 0.001F, kMedium>},
       {2.42, intrinsic_level<0, 24, 24, 0.05F, 1e-4F, kMedium>}},
      {3, 6, 8, 10}};
  return quality_levels;
}

}  // namespace inverse
