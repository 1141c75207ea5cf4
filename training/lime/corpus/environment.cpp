// SPDX-License-Identifier: LGPL-2.1-or-later
#include "environment.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::lime {

Vec texel_direction(int row, int column, int rows, int columns) {
  const float theta = (float(row) + 0.5f) / float(rows) * kPi;
  const float phi = ((float(column) + 0.5f) / float(columns) - 0.5f) * 2 * kPi;
  return {std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
}

float texel_solid_angle(int row, int rows, int columns) {
  return std::sin((float(row) + 0.5f) / float(rows) * kPi) * (kPi / float(rows)) *
         (2 * kPi / float(columns));
}

Vec Environment::look(Vec direction) const {
  const float v = std::acos(std::clamp(direction.y, -1.f, 1.f)) / kPi * float(rows) - 0.5f;
  const float u =
      (std::atan2(direction.x, direction.z) / (2 * kPi) + 0.5f) * float(columns()) - 0.5f;
  const float row = std::clamp(v, 0.f, float(rows - 1));
  const int r0 = int(row), r1 = std::min(r0 + 1, rows - 1);
  const float left = std::floor(u);
  const int c0 = (int(left) + columns()) % columns(), c1 = (c0 + 1) % columns();
  const float fr = row - float(r0), fc = u - left;
  return (1 - fr) * ((1 - fc) * at(r0, c0) + fc * at(r0, c1)) +
         fr * ((1 - fc) * at(r1, c0) + fc * at(r1, c1));
}

Environment shrink(const Environment& map, int rows) {
  const int n = map.rows / rows, columns = 2 * rows;
  Environment small{rows, std::vector<Vec>(std::size_t(rows * columns))};
  for (int row = 0; row < rows; ++row) {
    float weight = 0;
    for (int i = 0; i < n; ++i) {
      const float w = texel_solid_angle(row * n + i, map.rows, map.columns());
      weight += w * float(n);
      for (int column = 0; column < columns; ++column)
        for (int j = 0; j < n; ++j)
          small.at(row, column) += w * map.at(row * n + i, column * n + j);
    }
    for (int column = 0; column < columns; ++column)
      small.at(row, column) = (1 / weight) * small.at(row, column);
  }
  return small;
}

Environment turn(const Environment& map, int columns, bool mirrored) {
  Environment out{map.rows, std::vector<Vec>(map.radiance.size())};
  const int n = map.columns();
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < n; ++column) {
      const int from = ((column - columns) % n + n) % n;
      out.at(row, column) = map.at(row, mirrored ? n - 1 - from : from);
    }
  return out;
}

bool is_lit_from_front(const Environment& map) {
  const Environment small = shrink(map, map.rows / 4);
  float front = 0, all = 0;
  for (int row = 0; row < small.rows; ++row)
    for (int column = 0; column < small.columns(); ++column) {
      const float light = luminance(small.at(row, column));
      all = std::max(all, light);
      if (texel_direction(row, column, small.rows, small.columns()).z > 0.05f)
        front = std::max(front, light);
    }
  return front >= 0.6f * all;
}

void balance_white(Environment& map, float strength) {
  Vec mean;
  for (int row = 0; row < map.rows; ++row) {
    const float w = texel_solid_angle(row, map.rows, map.columns());
    for (int column = 0; column < map.columns(); ++column) mean += w * map.at(row, column);
  }
  const float gray = (mean.x + mean.y + mean.z) / 3;
  const auto gain = [&](float channel) {
    return std::pow(gray / std::max(channel, 1e-6f), strength);
  };
  const Vec gains{gain(mean.x), gain(mean.y), gain(mean.z)};
  for (Vec& e : map.radiance) e = gains * e;
}

}  // namespace inverse::lime
