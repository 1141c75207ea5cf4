#include "global_amount.hpp"

#include <algorithm>
#include <cmath>

#include "global_palette.hpp"

namespace inverse::reference::global {
namespace {

double candidate(double i) { return kLeastAmount * std::pow(kAmountRatio, i); }

double least(const std::array<double, kCandidates>& cost, const AmountParams& params,
             double prior) {
  std::array<double, kCandidates> c{};
  for (std::size_t i = 0; i < kCandidates; ++i) {
    const double off = std::log(candidate(double(i)) / params.typical);
    c[i] = cost[i] + prior * off * off;
  }
  const auto best = std::size_t(std::min_element(c.begin(), c.end()) - c.begin());
  if (best == 0 || best + 1 == kCandidates) return candidate(double(best));
  const double left = c[best - 1] - c[best], right = c[best + 1] - c[best];
  const double shift = left + right > 0 ? 0.5 * (left - right) / (left + right) : 0.0;
  return candidate(double(best) + shift);
}

}  // namespace

std::array<double, kCandidates> amount_cost(const Grid& grid, const std::vector<Vec3>& received,
                                            const AmountParams& params) {
  std::array<double, kCandidates> cost{};
  for (std::size_t k = 0; k < kCandidates; ++k) {
    ChromaHistogram histogram(64, 0.08);
    double neutral = 0, all = 1e-9;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      Vec3 light = received[i];
      for (double& v : light) v *= candidate(double(k));
      const Chroma left = grid.chroma[i] - tint_of(grid.shading[i], light);
      histogram.add(left, grid.weight[i]);
      neutral += grid.weight[i] *
                 std::exp(-norm2(left) / (2 * params.neutral_width * params.neutral_width));
      all += grid.weight[i];
    }
    cost[k] = histogram.entropy() - params.neutral * neutral / all;
  }
  return cost;
}

ChangeLeft change_left(const Grid& grid, const std::vector<Vec3>& received,
                       const LightBefore& before) {
  constexpr double kMost = 0.15;
  ChangeLeft left{};
  double all = 1e-9;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const double w = std::min(grid.weight[i], before.weight[i]);
    all += w;
    if (w <= 0) continue;
    const Chroma change = grid.chroma[i] - before.chroma[i];
    for (std::size_t k = 0; k <= kCandidates; ++k) {
      Chroma rest = change;
      if (k < kCandidates) {
        Vec3 now = received[i], then = before.received[i];
        for (std::size_t c = 0; c < 3; ++c)
          now[c] *= candidate(double(k)), then[c] *= candidate(double(k));
        rest = change - (tint_of(grid.shading[i], now) - tint_of(before.shading[i], then));
      }
      left[k] += w * std::min(norm2(rest), kMost * kMost);
    }
  }
  for (double& v : left) v /= all;
  return left;
}

Amount amount_of(const std::array<double, kCandidates>& from, const ChangeLeft& change,
                 const AmountParams& params) {
  if (params.manual > 0) return {params.manual, params.manual};
  std::array<double, kCandidates> cost = from;
  const double noise = params.noise * params.noise;
  for (std::size_t k = 0; k < kCandidates; ++k)
    cost[k] += params.time * std::log((change[k] + noise) / (change[kCandidates] + noise));
  return {least(cost, params, params.prior), least(cost, params, params.prior_split)};
}

}  // namespace inverse::reference::global
