// Other ways to let few lights stand for many, for comparison with LightReduction: by the
// environment alone.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "kernels/relight/lights/light_reduction.hpp"

namespace inverse::bench {

using Choose = std::function<LightReduction::Choice(const std::vector<Direction>&,
                                                    std::span<const Rgb> weights, size_t count)>;

/// Lights in clusters of near ones, each with the light of all its members, where the middle of
/// their light is (k-means on the sphere, from the brightest and farthest on).
LightReduction::Choice by_clusters(const std::vector<Direction>& lights,
                                   std::span<const Rgb> weights, size_t count);
/// The brightest lights; each other one's light goes to the nearest of them.
LightReduction::Choice brightest(const std::vector<Direction>& lights, std::span<const Rgb> weights,
                                 size_t count);

/// The smallest number of lights with which `choose` stays within an error that `judge` sees.
size_t fewest(const LightReduction& judge, const std::vector<Direction>& lights,
              std::span<const Rgb> weights, double max_error, const Choose& choose);

}  // namespace inverse::bench
