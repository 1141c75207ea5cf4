// SPDX-License-Identifier: LGPL-2.1-or-later
#include "quad.hpp"

#include <cmath>

namespace inverse {
namespace {

double cross(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
}

}  // namespace

double area_of(const Corners& corners) {
  double twice = 0;
  for (size_t i = 0; i < 4; ++i) {
    const Point &a = corners[i], &b = corners[(i + 1) % 4];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return twice / 2;
}

std::string wrong_corners(const Corners& corners) {
  for (const Point& p : corners)
    for (const double v : p)
      if (!(std::abs(v) <= kFarthest)) return "are not in or near the picture";
  const double area = area_of(corners);
  if (!(std::abs(area) >= kMinArea)) return "enclose no area";
  for (size_t i = 0; i < 4; ++i) {
    // Three corners on a line: the homography would be singular there.
    const double turn = cross(corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]);
    if (!(turn * (area > 0 ? 1 : -1) > 1e-3 * std::abs(area)))
      return "are not those of a convex quadrilateral in the order top left, top right, bottom "
             "right, bottom left";
  }
  return {};
}

Homography square_to(const Corners& corners) {
  const auto& [p0, p1, p2, p3] = corners;
  const double dx1 = p1[0] - p2[0], dx2 = p3[0] - p2[0], sx = p0[0] - p1[0] + p2[0] - p3[0];
  const double dy1 = p1[1] - p2[1], dy2 = p3[1] - p2[1], sy = p0[1] - p1[1] + p2[1] - p3[1];
  const double det = dx1 * dy2 - dx2 * dy1;
  const double g = (sx * dy2 - dx2 * sy) / det, h = (dx1 * sy - sx * dy1) / det;
  return {p1[0] - p0[0] + g * p1[0],
          p3[0] - p0[0] + h * p3[0],
          p0[0],
          p1[1] - p0[1] + g * p1[1],
          p3[1] - p0[1] + h * p3[1],
          p0[1],
          g,
          h,
          1};
}

Homography to_square(const Corners& corners) {
  const auto [a, b, c, d, e, f, g, h, i] = square_to(corners);
  const double det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
  Homography inverse{e * i - f * h, c * h - b * i, b * f - c * e, f * g - d * i, a * i - c * g,
                     c * d - a * f, d * h - e * g, b * g - a * h, a * e - b * d};
  for (double& v : inverse) v /= det;
  return inverse;
}

Point mapped(const Homography& h, Point p) {
  const double depth = h[6] * p[0] + h[7] * p[1] + h[8];
  return {(h[0] * p[0] + h[1] * p[1] + h[2]) / depth, (h[3] * p[0] + h[4] * p[1] + h[5]) / depth};
}

}  // namespace inverse
