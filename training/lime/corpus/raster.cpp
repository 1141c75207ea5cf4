// SPDX-License-Identifier: LGPL-2.1-or-later
#include "raster.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::lime {

void Raster::draw(const Grid& grid, const Pose& pose, const Camera& camera) {
  struct Corner {
    float x, y, near;
    Vec normal;
  };
  std::vector<Corner> corners;
  corners.reserve(grid.positions.size());
  for (std::size_t i = 0; i < grid.positions.size(); ++i) {
    const Vec p = pose.scale * pose.turn(grid.positions[i]) + pose.position;
    const float near = -1 / p.z;
    corners.push_back({camera.center_x + camera.focal * p.x * near,
                       camera.center_y - camera.focal * p.y * near, near,
                       pose.turn(grid.normals[i])});
  }
  each_triangle(grid, [&](int i, int j, int k) {
    const Corner &a = corners[std::size_t(i)], &b = corners[std::size_t(j)],
                 &c = corners[std::size_t(k)];
    // Outward winding is counter-clockwise with y up, clockwise here where y runs down.
    const float area = (c.x - a.x) * (b.y - a.y) - (b.x - a.x) * (c.y - a.y);
    if (area <= 0) return;
    const float left = std::min({a.x, b.x, c.x}), right = std::max({a.x, b.x, c.x});
    const float top = std::min({a.y, b.y, c.y}), bottom = std::max({a.y, b.y, c.y});
    const float last = float(size_ - 1);
    if (right < 0 || bottom < 0 || left > last + 1 || top > last + 1) return;
    const int x0 = int(std::ceil(std::max(left - 0.5f, 0.f))),
              x1 = int(std::floor(std::min(right - 0.5f, last)));
    const int y0 = int(std::ceil(std::max(top - 0.5f, 0.f))),
              y1 = int(std::floor(std::min(bottom - 0.5f, last)));
    const float scale = 1 / area;
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const float px = float(x) + 0.5f, py = float(y) + 0.5f;
        const float u = ((c.x - px) * (b.y - py) - (b.x - px) * (c.y - py)) * scale;
        const float v = ((a.x - px) * (c.y - py) - (c.x - px) * (a.y - py)) * scale;
        const float w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        const float near = u * a.near + v * b.near + w * c.near;
        float& nearest = near_[index(x, y)];
        if (near <= nearest) continue;
        nearest = near;
        normals_[index(x, y)] = u * a.normal + v * b.normal + w * c.normal;
      }
  });
}

}  // namespace inverse::lime
