// SPDX-License-Identifier: LGPL-2.1-or-later
#include "relight.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

constexpr double kLargest = 65504, kShadingFloor = 1.0 / 512;
constexpr double kMaxSlope = 1, kFollow = 0.2, kSmall = 0.1, kLargeChange = 0.5;
constexpr std::array<double, 4> kWeights{0.125, 0.375, 0.375, 0.125};

double dot(const Rgb& a, const Rgb& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// S C(S).
Rgb colored(const LightLayers& layers, double shading) {
  if (!layers.slope) return {shading, shading, shading};
  if (shading <= 0) return {};
  const double k = (*layers.slope)[0], above = std::log(shading) - (*layers.slope)[1];
  const double red = std::exp(std::clamp(k * above / 2, -20.0, 20.0));
  return {shading * red, shading, shading / red};
}

/// Weighted means of a grid at a place between its cells.
template <typename Value>
Value between(const std::vector<Value>& grid, unsigned width, unsigned height, double x, double y) {
  x = std::clamp(x, 0.0, width - 1.0), y = std::clamp(y, 0.0, height - 1.0);
  Value sum{};
  const auto left = static_cast<unsigned>(x), top = static_cast<unsigned>(y);
  for (unsigned j = top; j < std::min(top + 2, height); ++j)
    for (unsigned i = left; i < std::min(left + 2, width); ++i) {
      const double weight = std::max(1 - std::abs(x - i), 0.0) * std::max(1 - std::abs(y - j), 0.0);
      for (size_t c = 0; c < sum.size(); ++c) sum[c] += weight * grid[size_t{j} * width + i][c];
    }
  return sum;
}

}  // namespace

Rgb light_on(const Surface& surface, const std::vector<SceneLamp>& lamps) {
  Rgb sum{};
  for (const SceneLamp& lamp : lamps) {
    double share = 0;
    if (lamp.kind == SceneLamp::Kind::directional) {
      share = std::max(-dot(surface.normal, lamp.axis), 0.0);
    } else {
      Rgb to{};
      for (size_t c = 0; c < 3; ++c) to[c] = lamp.place[c] - surface.place[c];
      const double distance = std::max(std::sqrt(dot(to, to)), 1e-6);
      share = std::max(dot(surface.normal, to) / distance, 0.0) /
              std::max(distance * distance, lamp.radius * lamp.radius);
      if (lamp.kind == SceneLamp::Kind::spot) {
        const double edge = std::cos(lamp.angle);
        const double full = std::cos(lamp.angle * (1 - lamp.softness));
        share *= smooth((-dot(to, lamp.axis) / distance - edge) / std::max(full - edge, 2e-3));
      }
    }
    for (size_t c = 0; c < 3; ++c) sum[c] += share * lamp.light[c];
  }
  for (double& v : sum) v = std::min(v, kLargest);
  return sum;
}

Relit relight(const Rgba& intrinsic, const LightLayers& before, double keep, const Rgb& added) {
  const Rgba own = finite(intrinsic);
  const Rgba light = before.light ? finite(*before.light) : Rgba{1, 1, 1, 1};
  const double gray = (added[0] + added[1] + added[2]) / 3;
  Relit relit{own, light};
  relit.intrinsic[3] = std::min(keep * own[3] + gray, kLargest);
  const double now = relit.intrinsic[3];
  if (now <= 0) return relit;
  relit.kept = std::min(keep * own[3] / now, 1.0);
  if (keep == 1 && gray == 0) return relit;
  const Rgb was = colored(before, own[3]), unit = colored(before, now);
  for (size_t c = 0; c < 3; ++c)
    relit.light[c] =
        std::min((keep * was[c] * light[c] + added[c]) / std::max(unit[c], 1e-30), kLargest);
  relit.light[3] = std::min((keep * own[3] * light[3] + gray) / now, 1.0);
  return relit;
}

std::vector<std::array<double, 2>> relief_slopes(std::vector<double> u, unsigned width,
                                                 unsigned height, unsigned min_cells) {
  const auto at = [&](int x, int y) {
    x = std::clamp(x, 0, static_cast<int>(width) - 1);
    y = std::clamp(y, 0, static_cast<int>(height) - 1);
    return u[static_cast<size_t>(y) * width + static_cast<size_t>(x)];
  };
  std::vector<std::array<double, 2>> slopes(u.size());
  for (int y = 0; y < static_cast<int>(height); ++y)
    for (int x = 0; x < static_cast<int>(width); ++x)
      slopes[static_cast<size_t>(y) * width + static_cast<size_t>(x)] = {
          (at(x + 1, y) - at(x - 1, y)) / 2, (at(x, y + 1) - at(x, y - 1)) / 2};
  if (std::max(width, height) <= min_cells) return slopes;
  const unsigned half_width = (width + 1) / 2, half_height = (height + 1) / 2;
  std::vector<double> half;
  for (int y = 0; y < static_cast<int>(half_height); ++y)
    for (int x = 0; x < static_cast<int>(half_width); ++x) {
      double sum = 0;
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
          sum += kWeights[static_cast<size_t>(i)] * kWeights[static_cast<size_t>(j)] *
                 at(2 * x + i - 1, 2 * y + j - 1);
      half.push_back(sum);
    }
  const auto coarse = relief_slopes(half, half_width, half_height, min_cells);
  for (unsigned y = 0; y < height; ++y)
    for (unsigned x = 0; x < width; ++x) {
      const auto more = between(coarse, half_width, half_height, (x - .5) / 2, (y - .5) / 2);
      for (size_t c = 0; c < 2; ++c) slopes[size_t{y} * width + x][c] += more[c];
    }
  return slopes;
}

std::vector<double> log_cells(const std::vector<Rgba>& layers, unsigned width, unsigned height,
                              unsigned factor) {
  std::vector<double> cells;
  for (unsigned top = 0; top < height; top += factor)
    for (unsigned left = 0; left < width; left += factor) {
      double sum = 0, count = 0;
      for (unsigned y = top; y < std::min(top + factor, height); ++y)
        for (unsigned x = left; x < std::min(left + factor, width); ++x) {
          sum += std::log(std::max(finite(layers[size_t{y} * width + x])[3], kShadingFloor));
          count += 1;
        }
      cells.push_back(sum / count);
    }
  return cells;
}

void bound_slopes(std::vector<std::array<double, 2>>& slopes) {
  for (auto& [x, y] : slopes) {
    const double factor = 1 / std::sqrt(1 + (x * x + y * y) / (kMaxSlope * kMaxSlope));
    x *= factor, y *= factor;
  }
}

double follow_cell(double before, double now) {
  const double t = smooth((std::abs(now - before) - kSmall) / (kLargeChange - kSmall));
  return before + (kFollow + (1 - kFollow) * t) * (now - before);
}

std::array<double, 2> slope_at(const std::vector<std::array<double, 2>>& slopes, unsigned width,
                               unsigned height, double x, double y) {
  return between(slopes, width, height, x, y);
}

}  // namespace inverse::reference
