// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_choices.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace inverse::bench {
namespace {

double dot(const Direction& a, const Direction& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double brightness(const Rgb& w) { return double{w[0]} + w[1] + w[2]; }

/// Each light's light at the nearest of `kept`.
LightReduction::Choice gathered(const std::vector<Direction>& lights, std::span<const Rgb> weights,
                                std::vector<uint32_t> kept) {
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  LightReduction::Choice choice;
  choice.indices = kept;
  for (const uint32_t k : kept) choice.lights.push_back({lights[k], {}});
  for (size_t i = 0; i < lights.size(); ++i) {
    size_t nearest = 0;
    for (size_t k = 1; k < kept.size(); ++k)
      if (dot(lights[i], lights[kept[k]]) > dot(lights[i], lights[kept[nearest]])) nearest = k;
    for (size_t c = 0; c < 3; ++c) choice.lights[nearest].weight[c] += weights[i][c];
  }
  return choice;
}

uint32_t nearest_to(const std::vector<Direction>& lights, const Direction& w) {
  size_t best = 0;
  for (size_t i = 1; i < lights.size(); ++i)
    if (dot(lights[i], w) > dot(lights[best], w)) best = i;
  return static_cast<uint32_t>(best);
}

}  // namespace

LightReduction::Choice by_clusters(const std::vector<Direction>& lights,
                                   std::span<const Rgb> weights, size_t count) {
  std::vector<Direction> centers;
  std::vector<double> far(lights.size(), 4);
  for (size_t k = 0; k < count; ++k) {
    size_t best = 0;
    for (size_t i = 1; i < lights.size(); ++i)
      if (brightness(weights[i]) * far[i] > brightness(weights[best]) * far[best]) best = i;
    centers.push_back(lights[best]);
    for (size_t i = 0; i < lights.size(); ++i)
      far[i] = std::min(far[i], 2 - 2 * dot(lights[i], lights[best]));
  }
  for (int step = 0; step < 12; ++step) {
    std::vector<Direction> sums(centers.size());
    for (size_t i = 0; i < lights.size(); ++i) {
      size_t nearest = 0;
      for (size_t k = 1; k < centers.size(); ++k)
        if (dot(lights[i], centers[k]) > dot(lights[i], centers[nearest])) nearest = k;
      for (size_t c = 0; c < 3; ++c) sums[nearest][c] += brightness(weights[i]) * lights[i][c];
    }
    for (size_t k = 0; k < centers.size(); ++k) {
      const double length = std::sqrt(dot(sums[k], sums[k]));
      if (length <= 0) continue;
      for (size_t c = 0; c < 3; ++c) centers[k][c] = sums[k][c] / length;
    }
  }
  std::vector<uint32_t> kept;
  for (const Direction& center : centers) kept.push_back(nearest_to(lights, center));
  return gathered(lights, weights, kept);
}

LightReduction::Choice brightest(const std::vector<Direction>& lights, std::span<const Rgb> weights,
                                 size_t count) {
  std::vector<uint32_t> order(lights.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return brightness(weights[a]) > brightness(weights[b]);
  });
  order.resize(std::min(count, order.size()));
  return gathered(lights, weights, order);
}

size_t min_lights(const LightReduction& judge, const std::vector<Direction>& lights,
                  std::span<const Rgb> weights, double max_error, const Choose& choose) {
  // Errors are not monotonic in the number of lights: increase it by a quarter each time, then
  // decrease it one by one.
  size_t below = 0, count = 1;
  while (count < lights.size() &&
         judge.error(choose(lights, weights, count), weights, weights) > max_error) {
    below = count;
    count = std::max(count + 1, count * 5 / 4);
  }
  count = std::min(count, lights.size());
  for (size_t k = below + 1; k < count; ++k)
    if (judge.error(choose(lights, weights, k), weights, weights) <= max_error) return k;
  return count;
}

}  // namespace inverse::bench
