// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "global_thesis_params.hpp"
#include "kernels/quality_levels.hpp"

namespace inverse {

/// A level: Gauss–Newton steps, and conjugate-gradient steps for each.
template <int kSteps, int kPcg>
void global_thesis_level(GlobalThesisParams& params) {
  params.steps = kSteps;
  params.pcg_iterations = kPcg;
}

/// The quality levels of globalintrinsicthesis: processor time on lavapipe, scenes cornell and room
/// at 160 × 120 with eight and nine layers. Their energies in relation to 16 × 64 steps, by level:
/// cornell 7.95, 3.64, 1.14, 1.07, 1.04, 1.001; room 2.86, 1.45, 1.06, 1.04, 1.03, 1.01.
inline const QualityLevels<GlobalThesisParams>& global_thesis_levels() {
  static const QualityLevels<GlobalThesisParams> quality_levels{
      {{0.07, global_thesis_level<1, 8>},
       {0.14, global_thesis_level<2, 8>},
       {0.36, global_thesis_level<3, 16>},
       {0.61, global_thesis_level<5, 16>},
       {1.00, global_thesis_level<8, 16>},
       {1.93, global_thesis_level<16, 16>}},
      {2, 3, 4, 5}};
  return quality_levels;
}

}  // namespace inverse
