// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tests/depth/reference/strokes.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

namespace inverse::reference {

void mark(MarkedVoxels& voxels, double voxel, const std::vector<SceneStroke>& strokes) {
  std::map<uint32_t, std::vector<Cell>> brushed;
  for (auto& [cell, v] : voxels) {
    v.stroke = 0;
    if (!(std::abs(v.distance) < 1)) continue;
    for (const SceneStroke& stroke : strokes)
      for (const Vec4& ball : stroke.balls) {
        double squares = 0;
        for (size_t c = 0; c < 3; ++c) squares += std::pow((cell[c] + 0.5) * voxel - ball[c], 2);
        if (std::sqrt(squares) < ball[3]) v.stroke = stroke.id;
      }
    if (v.stroke) brushed[v.stroke].push_back(cell);
  }
  for (const SceneStroke& stroke : strokes) {
    if (!stroke.fill) continue;
    Vec3 mean{};
    double count = 0;
    std::deque<Cell> front;
    for (const Cell& cell : brushed[stroke.id]) {
      const MarkedVoxel& v = voxels.at(cell);
      if (!v.colored) continue;
      for (size_t c = 0; c < 3; ++c) mean[c] += std::exp(v.color[c]);
      ++count;
      front.push_back(cell);
    }
    for (double& m : mean) m /= std::max(count, 1.0);
    for (; !front.empty(); front.pop_front())
      for (int i = 0; i < 27; ++i) {
        const Cell next{front.front()[0] + i % 3 - 1, front.front()[1] + i / 3 % 3 - 1,
                        front.front()[2] + i / 9 - 1};
        const auto found = voxels.find(next);
        if (found == voxels.end() || found->second.stroke || !found->second.colored) continue;
        double squares = 0, factor = 1;
        for (size_t c = 0; c < 3; ++c) {
          const double color = std::exp(found->second.color[c]);
          squares += std::pow(color - mean[c], 2);
          factor = std::max({factor, color / mean[c], mean[c] / color});
        }
        if (!(std::sqrt(squares) < 0.1 && factor < 1.5)) continue;
        found->second.stroke = stroke.id;
        front.push_back(next);
      }
  }
}

double seen_stroke(const std::vector<uint32_t>& ids, const std::vector<double>& known_depth,
                   const std::vector<double>& depth, int width, int height,
                   const std::vector<uint32_t>& numbers, double x, double y) {
  const auto at = [&](int u, int v) { return size_t(v) * size_t(width) + size_t(u); };
  const size_t nearest = at(std::clamp(int(std::floor(x + 0.5)), 0, width - 1),
                            std::clamp(int(std::floor(y + 0.5)), 0, height - 1));
  const uint32_t number = numbers[ids[nearest]];
  const double here = depth[nearest], noise = 0.0012 + 0.0019 * (here - 0.4) * (here - 0.4);
  if (number == 0 || (here != 0 && !(std::abs(here - known_depth[nearest]) < 0.02 + 4 * noise)))
    return 0;
  double sum = 0, total = 0;
  for (int v = std::max(int(std::floor(y)) - 1, 0);
       v <= std::min(int(std::floor(y)) + 2, height - 1); ++v)
    for (int u = std::max(int(std::floor(x)) - 1, 0);
         u <= std::min(int(std::floor(x)) + 2, width - 1); ++u) {
      const double weight =
          std::max(1 - std::abs(u - x) / 2, 0.0) * std::max(1 - std::abs(v - y) / 2, 0.0);
      total += weight;
      if (ids[at(u, v)] == ids[nearest]) sum += weight;
    }
  const double deep = std::clamp(2 * sum / total - 1, 0.0, 1.0);
  return deep > 0 ? number + deep * deep / 2 : 0;
}

}  // namespace inverse::reference
