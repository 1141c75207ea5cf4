// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <random>

#include "detail.hpp"
#include "metrics.hpp"

namespace inverse::bench {
namespace {

constexpr double kMinReflectance = 1e-10;  // of a reflectance, as Bell et al.'s program has it
constexpr int kNear = 16;                  // pixels

double lightness(const Image& reflectance, int x, int y) {
  double sum = 0;
  for (int c = 0; c < reflectance.channels; ++c) sum += reflectance.at(x, y, c);
  return std::max(kMinReflectance, sum / reflectance.channels);
}

}  // namespace

Judgment::Darker compare(const Image& reflectance, const Judgment& points, double delta) {
  const double first = lightness(reflectance, points.x0, points.y0),
               second = lightness(reflectance, points.x1, points.y1);
  if (second / first > 1 + delta) return Judgment::Darker::first;
  if (first / second > 1 + delta) return Judgment::Darker::second;
  return Judgment::Darker::neither;
}

std::vector<Judgment> judge(const Image& truth, const Image& mask, int count, std::uint32_t seed,
                            double delta) {
  detail::check_sizes(truth, truth, mask);
  std::vector<std::pair<int, int>> places;
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x)
      if (detail::counts(mask, x, y)) places.emplace_back(x, y);
  std::vector<Judgment> judgments;
  if (places.size() < 2) return judgments;
  std::mt19937 random(seed);
  for (int k = 0; int(judgments.size()) < count && k < 20 * count; ++k) {
    const auto [x0, y0] = places[random() % places.size()];
    auto [x1, y1] = places[random() % places.size()];
    if (k % 2 == 0) {
      const auto near = [&](int v) { return v + int(random() % (2 * kNear + 1)) - kNear; };
      x1 = near(x0), y1 = near(y0);
      if (x1 < 0 || y1 < 0 || x1 >= truth.width || y1 >= truth.height ||
          !detail::counts(mask, x1, y1))
        continue;
    }
    if (x0 == x1 && y0 == y1) continue;
    Judgment j{x0, y0, x1, y1};
    j.darker = compare(truth, j, delta);
    judgments.push_back(j);
  }
  return judgments;
}

double whdr(const Image& reflectance, const std::vector<Judgment>& judgments, double delta) {
  double wrong = 0, total = 0;
  for (const Judgment& j : judgments) {
    if (compare(reflectance, j, delta) != j.darker) wrong += j.weight;
    total += j.weight;
  }
  return total > 0 ? wrong / total : 0.0;
}

}  // namespace inverse::bench
