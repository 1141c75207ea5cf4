#pragma once
#include "../quality.hpp"
#include "intrinsic_decomposition.hpp"

namespace inverse {

/// The cycles of a quality; everything else has its default.
inline IntrinsicDecomposition::Params intrinsic_preset(Quality quality) {
  constexpr uint32_t kCycles[] = {2, 4, 8, 24}, kWarmCycles[] = {1, 2, 4, 24};
  IntrinsicDecomposition::Params params;
  params.cycles = kCycles[static_cast<int>(quality)];
  params.warm_cycles = kWarmCycles[static_cast<int>(quality)];
  return params;
}

}  // namespace inverse
