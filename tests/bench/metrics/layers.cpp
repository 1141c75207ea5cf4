// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "detail.hpp"
#include "metrics.hpp"

namespace inverse::bench {
namespace {

using detail::counts;
using detail::kMinEnergy;

template <typename Each>
void for_each(const Image& image, const Image& mask, const Each& each) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (counts(mask, x, y)) each(x, y);
}

/// Coordinates of a color's logarithm across the gray axis, orthonormal.
std::array<double, 2> log_chroma(const Image& image, int x, int y, double scale) {
  constexpr double kFloor = 0.003;
  std::array<double, 3> l{};
  for (int c = 0; c < 3; ++c)
    l[std::size_t(c)] = std::log(std::max(0.0, scale * image.at(x, y, c)) + kFloor);
  return {(l[0] - l[1]) / std::sqrt(2.0), (l[0] + l[1] - 2 * l[2]) / std::sqrt(6.0)};
}

}  // namespace

double best_scale(const Image& estimate, const Image& truth, const Image& mask) {
  detail::check_sizes(estimate, truth, mask);
  double ee = 0, et = 0;
  for_each(truth, mask, [&](int x, int y) {
    for (int c = 0; c < truth.channels; ++c) {
      const double e = estimate.at(x, y, c);
      ee += e * e, et += e * truth.at(x, y, c);
    }
  });
  return ee > kMinEnergy ? et / ee : 0.0;
}

double relative_error(const Image& estimate, const Image& truth, const Image& mask, double scale) {
  detail::check_sizes(estimate, truth, mask);
  double error = 0, total = 0;
  for_each(truth, mask, [&](int x, int y) {
    for (int c = 0; c < truth.channels; ++c) {
      const double t = truth.at(x, y, c), d = scale * estimate.at(x, y, c) - t;
      error += d * d, total += t * t;
    }
  });
  return total > kMinEnergy ? error / total : 0.0;
}

double tint_error(const Image& shading, const Image& truth, const Image& mask) {
  const double scale = best_scale(shading, truth, mask);
  double sum = 0, count = 0;
  for_each(truth, mask, [&](int x, int y) {
    const auto a = log_chroma(shading, x, y, scale), b = log_chroma(truth, x, y, 1);
    sum += (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
    count += 1;
  });
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

LayerScores score_layers(const Image& direct, const Image& indirect, const Image& true_direct,
                         const Image& true_indirect, const Image& mask) {
  detail::check_sizes(direct, true_direct, mask);
  detail::check_sizes(indirect, true_indirect, mask);
  const auto sum = [](const Image& a, const Image& b) {
    Image out = a;
    for (std::size_t i = 0; i < out.data.size(); ++i) out.data[i] += b.data[i];
    return out;
  };
  const Image total = sum(direct, indirect), truth = sum(true_direct, true_indirect);
  const double joint = best_scale(total, truth, mask);
  return {relative_error(indirect, true_indirect, mask, best_scale(indirect, true_indirect, mask)),
          relative_error(direct, true_direct, mask, joint),
          relative_error(indirect, true_indirect, mask, joint), tint_error(total, truth, mask)};
}

}  // namespace inverse::bench
