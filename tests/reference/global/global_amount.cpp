// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_amount.hpp"

#include <algorithm>
#include <cmath>

#include "global_palette.hpp"

namespace inverse::reference::global {
namespace {

struct Moments {
  double mean = 0, variance = 0;  // of ln kappa
};

Moments moments(const AmountCost& cost, double measurement_weight, const AmountParams& params) {
  AmountCost energy;
  for (int i = 0; i < kCandidates; ++i) {
    const double off = std::log(candidate(i) / params.typical_amount) / params.spread;
    energy[std::size_t(i)] = measurement_weight * cost[std::size_t(i)] + 0.5 * off * off;
  }
  const double smallest = *std::min_element(energy.begin(), energy.end());
  double all = 0, first = 0, second = 0;
  for (int i = 0; i < kCandidates; ++i) {
    const double p = std::exp(smallest - energy[std::size_t(i)]), k = std::log(candidate(i));
    all += p, first += p * k, second += p * k * k;
  }
  const double mean = first / all;
  return {mean, std::max(0.0, second / all - mean * mean)};
}

double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

/// Mean shading around every point of the grid, so that its errors average out.
std::vector<double> shading_around(const Grid& grid) {
  constexpr double kMinShading = 1e-4;
  std::vector<double> out(grid.size());
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      double sum = 0, all = 0;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, grid.height - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, grid.width - 1); ++u) {
          const double share = std::exp(-double((u - x) * (u - x) + (v - y) * (v - y)));
          sum += share *
                 std::log(grid.shading[std::size_t(v) * std::size_t(grid.width) + std::size_t(u)] +
                          kMinShading);
          all += share;
        }
      out[std::size_t(y) * std::size_t(grid.width) + std::size_t(x)] = std::exp(sum / all);
    }
  return out;
}

}  // namespace

double candidate(int i) { return kMinAmount * std::pow(kAmountRatio, i); }

AmountCost amount_cost(const Grid& grid, const std::vector<Vec3>& received,
                       const AmountParams& params) {
  AmountCost cost{};
  const std::vector<double> shading = shading_around(grid);
  for (int k = 0; k < kCandidates; ++k) {
    ChromaHistogram histogram(64, 0.08);
    double neutral = 0, all = 1e-9;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      Vec3 light = received[i];
      for (double& v : light) v *= candidate(k);
      const Chroma left = grid.chroma[i] - tint_of(shading[i], light);
      histogram.add(left, grid.weight[i]);
      neutral += grid.weight[i] *
                 std::exp(-norm2(left) / (2 * params.neutral_width * params.neutral_width));
      all += grid.weight[i];
    }
    cost[std::size_t(k)] = histogram.entropy() - params.neutral * neutral / all;
  }
  return cost;
}

double color_spread(const Grid& grid) {
  double all = 1e-9;
  Chroma mean{};
  for (std::size_t i = 0; i < grid.size(); ++i) {
    mean = mean + grid.weight[i] * grid.chroma[i];
    all += grid.weight[i];
  }
  mean = (1 / all) * mean;
  double variance = 0;
  for (std::size_t i = 0; i < grid.size(); ++i)
    variance += grid.weight[i] * norm2(grid.chroma[i] - mean) / all;
  return std::sqrt(variance);
}

double usable_color(double spread, const AmountParams& params) {
  if (params.manual > 0) return 1;
  return smooth_step((spread - params.no_color) / (params.full_color - params.no_color));
}

Amount amount_of(const AmountCost& cost, double spread, const AmountParams& params) {
  if (params.manual > 0) return {params.manual, 1, 1};
  constexpr double kSure = 0.06;  // confidence that is enough for the color
  const double apart = std::min(1.0, spread / params.full_spread);
  const double usable = usable_color(spread, params);
  const Moments blind = moments(cost, 0, params),
                seen = moments(cost, apart * params.measurement_weight, params),
                sharp = moments(cost, params.measurement_weight, params);
  const auto confidence = [&](const Moments& m) {
    return usable * std::clamp(1 - m.variance / blind.variance, 0.0, 1.0);
  };
  return {usable * std::exp(seen.mean), confidence(seen), smooth_step(confidence(sharp) / kSure)};
}

}  // namespace inverse::reference::global
