// SPDX-License-Identifier: LGPL-2.1-or-later
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

Plane hidden_light(const Plane& underside, double ground, double soft) {
  constexpr double kCell = 1.0 / 16;
  Plane out(kGround, kGround);
  for (int row = 0; row < kGround; ++row)
    for (int column = 0; column < kGround; ++column) {
      const double x = (column + .5) * kCell - 2, z = (row + .5) * kCell - 2;
      double hidden = 0;
      for (int v = 0; v < kUnderside; ++v)
        for (int u = 0; u < kUnderside; ++u) {
          const Vec4& patch = underside.at(u, v);
          const double height = std::max(-patch[0] * kCell - ground, 0.0) + soft;
          hidden +=
              patch[1] * hidden_by(kCell * kCell, height,
                                   std::hypot((u + .5) * kCell - 1 - x, (v + .5) * kCell - 1 - z));
        }
      const double edge = std::clamp(2 * (2 - std::hypot(x, z)), 0.0, 1.0);
      out.at(column, row)[0] = std::min(hidden, 1.0) * edge * edge * (3 - 2 * edge);
    }
  return out;
}

double darkness(const Plane& hidden, const GroundView& view, double x, double y) {
  // From the picture to the ground, and to the object's own directions.
  const double right = (x - view.x) / view.radius;
  const double near = (view.ground + (y - view.y) / view.radius) / view.sine;
  const double c = std::cos(view.yaw), s = std::sin(view.yaw);
  const double u = (c * right - s * near + 2) * 16 - .5, v = (s * right + c * near + 2) * 16 - .5;
  if (!(u > 0 && v > 0 && u < kGround - 1.001 && v < kGround - 1.001)) return 0;
  const int a = static_cast<int>(u), b = static_cast<int>(v);
  const auto row = [&](int at) {
    return std::lerp(hidden.at(a, at)[0], hidden.at(a + 1, at)[0], u - a);
  };
  return view.strength * std::lerp(row(b), row(b + 1), v - b);
}

Vec4 over(const Vec4& object, double dark, const Vec4& below) {
  const double bare = 1 - object[3], left = below[3] * (1 - dark);
  const double alpha = object[3] + bare * (dark + left);
  Vec4 out{0, 0, 0, alpha};
  for (std::size_t c = 0; c < 3; ++c)
    out[c] = (object[c] + bare * left * below[c]) / std::max(alpha, 1e-6);
  return out;
}

}  // namespace inverse::reference
