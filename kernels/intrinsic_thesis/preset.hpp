#pragma once
#include "../quality.hpp"
#include "thesis_params.hpp"

namespace inverse {

/// The iterations of a quality; everything else has its default. The thesis runs 4 × 8 (section
/// 3.6.5) and shows convergence with 7 × 8.
inline ThesisParams thesis_preset(Quality quality) {
  constexpr int kIrls[] = {2, 4, 7, 16};
  ThesisParams params;
  params.irls_iterations = kIrls[static_cast<int>(quality)];
  params.pcg_iterations = quality == Quality::best ? 16 : 8;
  return params;
}

}  // namespace inverse
