#include "raster.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace inverse::reference {

const std::array<std::array<double, 2>, 8> kSamplePoints{{{9 / 16., 5 / 16.},
                                                          {7 / 16., 11 / 16.},
                                                          {13 / 16., 9 / 16.},
                                                          {5 / 16., 3 / 16.},
                                                          {3 / 16., 13 / 16.},
                                                          {1 / 16., 7 / 16.},
                                                          {11 / 16., 15 / 16.},
                                                          {15 / 16., 1 / 16.}}};

Hit look(const std::vector<Triangle>& triangles, double x, double y) {
  Hit hit;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Triangle& c = triangles[t];
    std::array<double, 3> weight{};
    double area = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 &p = c[(i + 1) % 3], &q = c[(i + 2) % 3];
      weight[i] = (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
      area += weight[i];
      // Distance from the edge, as a piece of a line.
      const double length2 = std::pow(q[0] - p[0], 2) + std::pow(q[1] - p[1], 2);
      const double along =
          length2 > 0
              ? std::clamp(((x - p[0]) * (q[0] - p[0]) + (y - p[1]) * (q[1] - p[1])) / length2, 0.0,
                           1.0)
              : 0;
      hit.margin = std::min(hit.margin, std::hypot(x - p[0] - along * (q[0] - p[0]),
                                                   y - p[1] - along * (q[1] - p[1])));
    }
    if (area == 0) continue;
    double depth = 0;
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      inside = inside && weight[i] / area >= 0;
      depth += weight[i] / area * c[i][2];
    }
    if (inside && (hit.triangle < 0 || depth > hit.depth)) {
      hit.triangle = static_cast<int>(t);
      hit.depth = depth;
    }
  }
  return hit;
}

double hidden_by(double area, double height, double distance) {
  const double h2 = height * height + area / std::numbers::pi;
  return h2 * area / (std::numbers::pi * std::pow(distance * distance + h2, 2));
}

}  // namespace inverse::reference
