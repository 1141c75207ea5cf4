// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/quality_levels.hpp"
#include "scaled_intrinsic.hpp"

namespace inverse {

/// The levels of intrinsicdecomp (docs/reference/methods/intrinsicdecomp.md, 12).
inline const QualityLevels<ScaledIntrinsic::Params>& intrinsic_levels() {
  using Params = ScaledIntrinsic::Params;
  // Its cost, resolution, cycles of the first frame and of those after it, and two tolerances. A
  // network's output serves two frames, but at the highest level.
  const auto level = [](double cost, size_t halvings, uint32_t cycles, uint32_t warm, float edge,
                        float cycle) {
    return Level<Params>{cost, [=](Params& params) {
                           params.set_halvings(halvings);
                           params.cycles = cycles;
                           params.warm_cycles = warm;
                           params.tolerances.edge = edge;
                           params.tolerances.cycle = cycle;
                           params.prior.network_interval = warm < 24 ? 2 : 1;
                         }};
  };
  static const QualityLevels<Params> quality_levels{
      {level(0.37, 2, 2, 1, 0.1F, 0.01F), level(0.46, 1, 3, 1, 0.1F, 0.01F),
       level(0.52, 1, 4, 2, 0.1F, 0.01F), level(0.53, 1, 4, 2, 0.05F, 0.01F),
       level(0.61, 1, 8, 4, 0.05F, 0.003F), level(0.98, 0, 4, 2, 0.1F, 0.01F),
       level(1.00, 0, 4, 2, 0.05F, 0.01F), level(1.26, 0, 8, 4, 0.05F, 0.01F),
       level(1.27, 0, 8, 4, 0.05F, 0.003F), level(1.48, 0, 12, 8, 0.05F, 0.001F),
       level(2.42, 0, 24, 24, 0.05F, 1e-4F)},
      {3, 6, 8, 10}};
  return quality_levels;
}

}  // namespace inverse
