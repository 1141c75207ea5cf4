// SPDX-License-Identifier: LGPL-2.1-or-later
#include "known_targets.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kMargin = 0.02, kSteps = 4, kColor = 0.4;

/// Nguyen et al. 2012.
double noise(double z) { return 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4); }

}  // namespace

Plane known_targets(const Plane& image, const KnownReflectance& known, double log_scale,
                    const ThesisParams& params) {
  Plane targets(image.width, image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const int kx = int((2LL * x + 1) * known.width / (2LL * image.width)),
                ky = int((2LL * y + 1) * known.height / (2LL * image.height));
      const auto at = std::size_t(ky * known.width + kx);
      const double here = known.depth[at], there = known.known_depth[at];
      if (!(here > 0 && there > 0 && std::abs(here - there) < kMargin + kSteps * noise(here) &&
            known.confidence[at] > 0))
        continue;
      const double* r = &known.log_reflectance[3 * at];
      const double mean_r = (r[0] + r[1] + r[2]) / 3;
      const Vec4& light = image.at(x, y);
      double mean_i = 0;
      for (int c = 0; c < 3; ++c) mean_i += std::log(std::max(light[c], params.log_floor)) / 3;
      Vec3 k;
      for (int c = 0; c < 3; ++c)
        k[c] = std::log((light[c] + params.chroma_floor) /
                        (std::exp(std::min(r[c] - mean_r + mean_i, 20.0)) + params.chroma_floor));
      const double across = k[0] - k[1], along = (k[0] + k[1]) / 2 - k[2],
                   share = 1 / (1 + (0.75 * across * across + along * along) / (kColor * kColor));
      Vec4& target = targets.at(x, y);
      for (int c = 0; c < 3; ++c) target[c] = share * (r[c] - log_scale);
      target[3] = share;
    }
  return targets;
}

}  // namespace inverse::reference
