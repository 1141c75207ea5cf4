// SPDX-License-Identifier: LGPL-2.1-or-later
#include "prefiltered_light.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace inverse {
namespace {

constexpr double kPi = std::numbers::pi;
using Rgb = std::array<double, 3>;

double luminance(const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

/// Weight of a kernel of radius 1 at this distance.
double kernel(double distance) {
  const double t = 1 - distance * distance;
  return t > 0 ? t * t : 0;
}

std::vector<PrefilteredLight::Vec4> make_cells(const Environment& map) {
  constexpr uint32_t kRows = PrefilteredLight::kCellRows, kColumns = 2 * kRows;
  struct Cell {
    Rgb flux{}, moment{};
    double weight = 0;
  };
  std::vector<Cell> cells(size_t{kRows} * kColumns);
  const Extent extent = map.extent();
  // Pixels of coarse maps count as areas, not as points.
  const uint32_t split = std::max(1U, 128 / extent.height);
  const uint32_t rows = extent.height * split, columns = extent.width * split;
  // Sines and cosines of all columns, computed once: maps have up to 134 million pixels.
  std::vector<Rgb> around(columns);
  for (uint32_t column = 0; column < columns; ++column)
    around[column] = map.direction((column + 0.5) / split, extent.height / 2.0);
  for (uint32_t row = 0; row < rows; ++row) {
    const double polar = kPi * (row + 0.5) / rows, out = std::sin(polar), up = std::cos(polar);
    const double area =
        2 * kPi / columns * (std::cos(kPi * row / rows) - std::cos(kPi * (row + 1) / rows));
    for (uint32_t column = 0; column < columns; ++column) {
      const float* rgb = &map.rgb()[3 * (size_t{row / split} * extent.width + column / split)];
      const Rgb flux{area * rgb[0], area * rgb[1], area * rgb[2]};
      Cell& cell = cells[size_t{row * kRows / rows} * kColumns + column * kColumns / columns];
      const Rgb w{out * around[column][0], up, out * around[column][2]};
      const double weight = luminance(flux);
      for (size_t c = 0; c < 3; ++c) {
        cell.flux[c] += flux[c];
        cell.moment[c] += weight * w[c];
      }
      cell.weight += weight;
    }
  }
  std::vector<PrefilteredLight::Vec4> result;
  for (const Cell& cell : cells) {
    const double scale = cell.weight > 0 ? 1 / cell.weight : 0;
    PrefilteredLight::Vec4 flux{}, direction{};
    for (size_t c = 0; c < 3; ++c) {
      flux[c] = static_cast<float>(cell.flux[c]);
      direction[c] = static_cast<float>(scale * cell.moment[c]);
    }
    result.push_back(flux);
    result.push_back(direction);
  }
  return result;
}

struct Level {
  uint32_t rows;
  std::vector<Rgb> texels;
  uint32_t columns() const { return 2 * rows; }
};

/// Resamples a map: means over the solid angle of each pixel.
Level resampled(const Environment& map, uint32_t rows) {
  Level level{rows, std::vector<Rgb>(size_t{2} * rows * rows)};
  const Extent from = map.extent();
  const double scale = static_cast<double>(from.height) / rows;
  // First along rows, then along columns.
  std::vector<Rgb> narrow(size_t{from.height} * level.columns());
  for (uint32_t y = 0; y < from.height; ++y)
    for (uint32_t column = 0; column < level.columns(); ++column) {
      const double left = column * scale, right = (column + 1) * scale;
      const auto last = std::min(from.width, static_cast<uint32_t>(std::ceil(right)));
      for (auto x = static_cast<uint32_t>(left); x < last; ++x) {
        const double share = (std::min(right, x + 1.0) - std::max<double>(left, x)) / scale;
        for (size_t c = 0; c < 3; ++c)
          narrow[size_t{y} * level.columns() + column][c] +=
              share * map.rgb()[3 * (size_t{y} * from.width + x) + c];
      }
    }
  for (uint32_t row = 0; row < rows; ++row) {
    const double top = row * scale, bottom = (row + 1) * scale;
    const auto area = [&](double from_row, double to_row) {
      return std::cos(kPi * from_row / from.height) - std::cos(kPi * to_row / from.height);
    };
    const auto last = std::min(from.height, static_cast<uint32_t>(std::ceil(bottom)));
    for (auto y = static_cast<uint32_t>(top); y < last; ++y) {
      const double share =
          area(std::max<double>(top, y), std::min(bottom, y + 1.0)) / area(top, bottom);
      for (uint32_t column = 0; column < level.columns(); ++column)
        for (size_t c = 0; c < 3; ++c)
          level.texels[size_t{row} * level.columns() + column][c] +=
              share * narrow[size_t{y} * level.columns() + column][c];
    }
  }
  return level;
}

/// Half the rows, blurred by a kernel on the sphere whose radius is 1.5 times the distance of the
/// new rows: a small lamp has the same weight at every position.
Level halved(const Level& fine) {
  Level coarse{fine.rows / 2, std::vector<Rgb>(fine.texels.size() / 4)};
  const double spacing = kPi / fine.rows, radius = 3 * spacing;
  const auto columns = static_cast<int>(fine.columns());
  std::vector<double> weights(fine.columns());
  for (uint32_t row = 0; row < coarse.rows; ++row) {
    const double polar = (2 * row + 1) * spacing;
    std::vector<double> total(coarse.columns());
    for (uint32_t y = 0; y < fine.rows; ++y) {
      const double at = (y + 0.5) * spacing;
      if (std::fabs(at - polar) >= radius) continue;
      // By the distance in columns, which is a whole number plus a half.
      int reach = 0;
      for (int d = 0; d < columns / 2; ++d) {
        const double cosine = std::cos(at) * std::cos(polar) +
                              std::sin(at) * std::sin(polar) * std::cos((d + 0.5) * spacing);
        weights[static_cast<size_t>(d)] =
            kernel(std::acos(std::clamp(cosine, -1.0, 1.0)) / radius) * std::sin(at);
        if (weights[static_cast<size_t>(d)] > 0) reach = d + 1;
      }
      for (uint32_t column = 0; column < coarse.columns(); ++column)
        for (int d = -reach; d < reach; ++d) {
          const double weight = weights[static_cast<size_t>(d < 0 ? -d - 1 : d)];
          const int x = (static_cast<int>(2 * column) + 1 + d + columns) % columns;
          const Rgb& from = fine.texels[size_t{y} * fine.columns() + static_cast<size_t>(x)];
          Rgb& to = coarse.texels[size_t{row} * coarse.columns() + column];
          for (size_t c = 0; c < 3; ++c) to[c] += weight * from[c];
          total[column] += weight;
        }
    }
    for (uint32_t column = 0; column < coarse.columns(); ++column)
      for (double& c : coarse.texels[size_t{row} * coarse.columns() + column]) c /= total[column];
  }
  return coarse;
}

}  // namespace

PrefilteredLight::PrefilteredLight(const Environment& environment)
    : cells(make_cells(environment)) {
  rows = std::clamp(std::bit_ceil(environment.extent().height), 2 * kMinRows, kMaxRows);
  for (Level level = resampled(environment, rows);; level = halved(level)) {
    ++levels;
    for (const Rgb& c : level.texels)
      texels.push_back(
          {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]), 0});
    if (level.rows == kMinRows) return;
  }
}

}  // namespace inverse
