// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace inverse {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kReach = 1.5;      // spacings
constexpr double kMinReach = 0.05;  // radian: minimum area for coincident lights
constexpr uint32_t kRows = LightCells::kRows, kColumns = 2 * kRows;

double dot(const Direction& a, const Direction& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double solid_angle(double top, double bottom, uint32_t rows) {
  return std::cos(kPi * top / rows) - std::cos(kPi * bottom / rows);
}

/// Resampling of one axis of a map: the range of old parts that each new part covers.
struct Overlap {
  uint32_t to, from;
  double begin, end;  // in old parts
};
std::vector<Overlap> overlaps(uint32_t from, uint32_t to) {
  std::vector<Overlap> result;
  const double scale = static_cast<double>(from) / to;
  for (uint32_t t = 0; t < to; ++t) {
    const double begin = t * scale, end = (t + 1) * scale;
    for (auto f = static_cast<uint32_t>(begin); f < from && f < end; ++f)
      if (const double low = std::max<double>(begin, f), high = std::min<double>(end, f + 1);
          high > low)
        result.push_back({t, f, low, high});
  }
  return result;
}

}  // namespace

double light_spacing(std::span<const Direction> lights) {
  if (lights.size() < 2) return kPi;
  std::vector<double> nearest;
  for (size_t i = 0; i < lights.size(); ++i) {
    double best = -1;
    for (size_t k = 0; k < lights.size(); ++k)
      if (k != i) best = std::max(best, dot(lights[i], lights[k]));
    nearest.push_back(std::acos(std::clamp(best, -1.0, 1.0)));
  }
  const auto middle = nearest.begin() + static_cast<ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

LightCells::LightCells(std::vector<Direction> lights)
    : lights_(std::move(lights)), owner_(size_t{kRows} * kColumns, kNone) {
  const double reach = std::cos(std::clamp(kReach * light_spacing(lights_), kMinReach, kPi));
  // From the top down, so that each row checks only lights within reach.
  std::vector<uint16_t> order(lights_.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<uint16_t>(i);
  std::sort(order.begin(), order.end(),
            [this](uint16_t a, uint16_t b) { return lights_[a][1] > lights_[b][1]; });
  const double reach_angle = std::acos(std::clamp(reach, -1.0, 1.0));
  for (uint32_t row = 0; row < kRows; ++row) {
    const double polar = kPi * (row + 0.5) / kRows;
    const double high = std::cos(std::max(0.0, polar - reach_angle)),
                 low = std::cos(std::min(kPi, polar + reach_angle));
    const auto above = [this](uint16_t i, double y) { return lights_[i][1] > y; };
    const auto first = std::lower_bound(order.begin(), order.end(), high + 1e-9, above);
    const auto last = std::lower_bound(order.begin(), order.end(), low - 1e-9, above);
    const double area = 2 * kPi / kColumns * solid_angle(row, row + 1, kRows);
    for (uint32_t column = 0; column < kColumns; ++column) {
      const double azimuth = 2 * kPi * ((column + 0.5) / kColumns - 0.5);
      const Direction w{std::sin(polar) * std::sin(azimuth), std::cos(polar),
                        std::sin(polar) * std::cos(azimuth)};
      double best = reach;
      uint16_t& owner = owner_[size_t{row} * kColumns + column];
      for (auto it = first; it != last; ++it)
        if (const double near = dot(lights_[*it], w); near >= best) {
          best = near;
          owner = *it;
        }
      if (owner != kNone) covered_ += area;
    }
  }
}

LightCells::Map LightCells::map(const Environment& environment) {
  const Extent extent = environment.extent();
  Map result{std::vector<float>(size_t{3} * kRows * kColumns)};
  std::vector<double> sums(result.flux.size());
  const auto columns = overlaps(extent.width, kColumns);
  std::vector<double> line(size_t{3} * kColumns);
  uint32_t summed = ~0U;  // the row that `line` is of
  for (const Overlap& row : overlaps(extent.height, kRows)) {
    if (row.from != summed) {
      std::fill(line.begin(), line.end(), 0.0);
      const float* rgb = &environment.rgb()[size_t{3} * row.from * extent.width];
      for (const Overlap& column : columns)
        for (size_t c = 0; c < 3; ++c)
          line[3 * column.to + c] += (column.end - column.begin) * rgb[3 * column.from + c];
      summed = row.from;
    }
    const double area = 2 * kPi / extent.width * solid_angle(row.begin, row.end, extent.height);
    for (size_t i = 0; i < line.size(); ++i)
      sums[size_t{3} * kColumns * row.to + i] += area * line[i];
  }
  std::transform(sums.begin(), sums.end(), result.flux.begin(),
                 [](double v) { return static_cast<float>(v); });
  return result;
}

std::vector<Rgb> LightCells::weights(const Map& map, double rotation) const {
  std::vector<std::array<double, 3>> sums(lights_.size());
  const double turns = std::isfinite(rotation) ? rotation / (2 * kPi) : 0;
  const double shift = (turns - std::floor(turns)) * kColumns;  // columns to the right
  const auto whole = static_cast<uint32_t>(shift) % kColumns;
  const double part = shift - std::floor(shift);
  for (uint32_t row = 0; row < kRows; ++row) {
    const float* flux = &map.flux[size_t{3} * row * kColumns];
    for (uint32_t column = 0; column < kColumns; ++column) {
      const uint16_t owner = owner_[size_t{row} * kColumns + column];
      if (owner == kNone) continue;
      // Rotation by a fraction of a patch distributes it over two.
      const uint32_t near = (column + kColumns - whole) % kColumns;
      const uint32_t far = (near + kColumns - 1) % kColumns;
      for (size_t c = 0; c < 3; ++c)
        sums[owner][c] += (1 - part) * flux[3 * near + c] + part * flux[3 * far + c];
    }
  }
  const double scale = static_cast<double>(lights_.size()) / covered_;
  std::vector<Rgb> result(lights_.size());
  for (size_t i = 0; i < sums.size(); ++i)
    for (size_t c = 0; c < 3; ++c) result[i][c] = static_cast<float>(scale * sums[i][c]);
  return result;
}

double LightCells::shown(const Map& map, std::span<const Rgb> weights, double covered) {
  double all = 0, taken = 0;
  for (const float v : map.flux) all += v;
  for (const Rgb& w : weights) taken += double{w[0]} + w[1] + w[2];
  if (all <= 0 || weights.empty()) return 1;
  return std::min(1.0, taken * covered / static_cast<double>(weights.size()) / all);
}

}  // namespace inverse
