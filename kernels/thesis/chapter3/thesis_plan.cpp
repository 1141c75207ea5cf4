// SPDX-License-Identifier: LGPL-2.1-or-later
#include "thesis_plan.hpp"

#include <algorithm>

namespace inverse {

ThesisPlan plan_thesis(const ThesisParams& params, int levels, int stored, uint32_t frames) {
  ThesisPlan plan;
  const bool samples = params.w_non_local > 0 && params.samples > 0;
  if (samples) plan.keyframes = std::min(stored, params.keyframes);
  plan.store_keyframe = samples && params.keyframes > 0 &&
                        frames % static_cast<uint32_t>(params.keyframe_spacing) == 0;
  // A single level has nothing to cluster beforehand.
  plan.clustered = levels > 1 && params.w_clustering > 0;
  if (!samples)
    plan.skipped.emplace_back("samples: none, or their weight is 0");
  else if (plan.keyframes == 0)
    plan.skipped.emplace_back("keyframes: none so far, or none wanted");
  if (params.w_clustering <= 0) plan.skipped.emplace_back("clusters: their weight is 0");
  return plan;
}

int thesis_levels(Extent extent, int requested) {
  int possible = 1;
  for (uint32_t side = std::max(extent.width, extent.height); side > 1; side = (side + 1) / 2) {
    ++possible;
  }
  int wanted = requested;
  if (requested <= 0) {
    wanted = 3;
    for (uint32_t side = std::min(extent.width, extent.height) / 4; side >= 48 && wanted < 5;
         side /= 2) {
      ++wanted;
    }
  }
  return std::min(wanted, possible);
}

}  // namespace inverse
