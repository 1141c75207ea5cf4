// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <vector>

#include "plan.hpp"

namespace inverse::network {

/// The weights of a step in the order in which its kernel reads them (convolve3.glsl,
/// convolve1.comp, depthwise3.comp, dense.comp): vec4 by vec4, zeros for the missing channels of a
/// block.
std::vector<float> packed_weights(const Graph& graph, const Plan& plan, const Step& step);

}  // namespace inverse::network
