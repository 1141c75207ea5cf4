// SPDX-License-Identifier: LGPL-2.1-or-later
#include "memory.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {

std::vector<double> read_depth(const std::vector<uint16_t>& steps, double unit) {
  std::vector<double> meters;
  for (const uint16_t step : steps) meters.push_back(step == 65535 ? 0 : step * unit);
  return meters;
}

Plane resize(const Plane& plane, int width, int height) {
  Plane resized(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Vec4& mean = resized.data[resized.index(x, y)];
      for (int k = 0; k < 16; ++k) {
        // (8 x + 2 k + 1) / 8 of a pixel's side, in whole numbers.
        const auto nearest = [](long at, long from, long to) {
          return int(std::min(at * from / (8 * to), from - 1));
        };
        const Vec4& from =
            plane.data[plane.index(nearest(8L * x + 2 * (k % 4) + 1, plane.width, width),
                                   nearest(8L * y + 2 * (k / 4) + 1, plane.height, height))];
        for (std::size_t c = 0; c < 4; ++c) mean[c] += from[c] / 16;
      }
    }
  return resized;
}

Vec4 seen_surface(const Vec4& view, const Vec4& measured) {
  constexpr double kMargin = 0.02, kSteps = 4;
  const auto has_normal = [](const Vec4& seen) {
    return seen[3] > 0 && seen[0] * seen[0] + seen[1] * seen[1] + seen[2] * seen[2] > 0;
  };
  const double noise = 0.0012 + 0.0019 * (measured[3] - 0.4) * (measured[3] - 0.4);
  const bool same = std::abs(measured[3] - view[3]) < kMargin + kSteps * noise;
  if (has_normal(measured) && !(has_normal(view) && same)) return measured;
  return has_normal(view) ? view : Vec4{};
}

Thumbnail thumbnail(int width, int height, const std::vector<double>& brightness,
                    const std::vector<double>& depth) {
  constexpr int kAcross = 16, kDown = 12;
  Thumbnail made;
  for (int cy = 0; cy < kDown; ++cy)
    for (int cx = 0; cx < kAcross; ++cx) {
      const int left = cx * width / kAcross, top = cy * height / kDown;
      const int right = std::max((cx + 1) * width / kAcross, left + 1),
                bottom = std::max((cy + 1) * height / kDown, top + 1);
      double bright = 0, count = 0, far = 0, known = 0;
      for (int y = top; y < std::min(bottom, height); ++y)
        for (int x = left; x < std::min(right, width); ++x) {
          const auto at = std::size_t(y) * std::size_t(width) + std::size_t(x);
          bright += brightness[at];
          ++count;
          if (depth[at] > 0) far += depth[at], ++known;
        }
      made.brightness.push_back(count > 0 ? bright / count : 0);
      made.depth.push_back(known > 0 ? far / known : 0);
    }
  return made;
}

}  // namespace inverse::reference
