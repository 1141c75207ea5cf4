// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/quality_levels.hpp"
#include "thesis_params.hpp"

namespace inverse {

/// A level: reweightings, and conjugate-gradient steps for each.
template <int kIrls, int kPcg>
void thesis_level(ThesisParams& params) {
  params.irls_iterations = kIrls;
  params.pcg_iterations = kPcg;
}

/// The quality levels of intrinsicdecompthesis. The thesis runs 4 x 8
/// iterations (section 3.6.5) and shows convergence with 7 x 8.
inline const QualityLevels<ThesisParams>& thesis_levels() {
  static const QualityLevels<ThesisParams> quality_levels{{{0.26, thesis_level<1, 4>},
                                                           {0.32, thesis_level<1, 8>},
                                                           {0.61, thesis_level<2, 8>},
                                                           {0.77, thesis_level<3, 8>},
                                                           {1.00, thesis_level<4, 8>},
                                                           {1.66, thesis_level<7, 8>},
                                                           {6.6, thesis_level<16, 16>}},
                                                          {2, 4, 5, 6}};
  return quality_levels;
}

}  // namespace inverse
