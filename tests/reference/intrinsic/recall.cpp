// SPDX-License-Identifier: LGPL-2.1-or-later
#include "recall.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kMargin = 0.02, kSteps = 4, kColor = 0.4, kChromaFloor = 0.01;

/// Nguyen et al. 2012.
double noise(double z) { return 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4); }

}  // namespace

void recall(const Guide& guide, const KnownReflectance& known, double log_scale, EdgePrior& prior) {
  const GuideLevel &fine = guide.level[0], &cells = guide.level[kCellLevel];
  for (int y = 0; y < cells.height; ++y)
    for (int x = 0; x < cells.width; ++x) {
      double total = 0;
      std::array<double, 3> sum{};
      for (int k = 0; k < 16; ++k) {
        const int px = std::min(4 * x + k % 4, fine.width - 1),
                  py = std::min(4 * y + k / 4, fine.height - 1);
        const auto nearest = [](int pixel, int of, int size) {
          return int((2LL * pixel + 1) * size / (2LL * of));
        };
        const int at = nearest(py, fine.height, known.height) * known.width +
                       nearest(px, fine.width, known.width);
        const double z = known.depth[std::size_t(at)], there = known.known_depth[std::size_t(at)],
                     w = known.confidence[std::size_t(at)];
        if (!(z > 0 && there > 0 && std::abs(z - there) < kMargin + kSteps * noise(z) && w > 0))
          continue;
        total += w;
        for (std::size_t c = 0; c < 3; ++c)
          sum[c] += w * known.log_reflectance[3 * std::size_t(at) + c];
      }
      if (total == 0) continue;
      const std::size_t i = cells.index(x, y);
      const double mean = (sum[0] + sum[1] + sum[2]) / (3 * total);
      std::array<double, 3> color;
      for (std::size_t c = 0; c < 3; ++c)
        color[c] =
            std::log(std::exp(std::min(sum[c] / total - mean + cells.m[i], 9.0)) + kChromaFloor);
      const double d0 = std::sqrt(3) / 2 * (color[0] - color[1]) - cells.c0[i],
                   d1 = (color[0] + color[1]) / 2 - color[2] - cells.c1[i];
      const double t = known.weight * total / (1 + (d0 * d0 + d1 * d1) / (kColor * kColor)),
                   target = cells.m[i] - mean + log_scale;
      prior.V[i] = (prior.v[i] * prior.V[i] + t * target) / (prior.v[i] + t);
      prior.v[i] += t;
    }
}

}  // namespace inverse::reference
