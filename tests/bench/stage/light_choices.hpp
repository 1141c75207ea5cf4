// SPDX-License-Identifier: LGPL-2.1-or-later
// Other ways to select few lights, from the environment alone, for comparison with LightReduction.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "kernels/relight/lights/light_reduction.hpp"

namespace inverse::bench {

using Choose = std::function<LightReduction::Choice(const std::vector<Direction>&,
                                                    std::span<const Rgb> weights, size_t count)>;

/// Clusters of neighboring lights, each with the sum of its members' light at their centroid
/// (k-means on the sphere, initialized with the brightest and farthest).
LightReduction::Choice by_clusters(const std::vector<Direction>& lights,
                                   std::span<const Rgb> weights, size_t count);
/// The brightest lights; each other light is added to the nearest of them.
LightReduction::Choice brightest(const std::vector<Direction>& lights, std::span<const Rgb> weights,
                                 size_t count);

/// The smallest number of lights for which `choose` stays within an error measured by `judge`.
size_t min_lights(const LightReduction& judge, const std::vector<Direction>& lights,
                  std::span<const Rgb> weights, double max_error, const Choose& choose);

}  // namespace inverse::bench
