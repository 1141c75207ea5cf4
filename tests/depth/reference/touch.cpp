// SPDX-License-Identifier: LGPL-2.1-or-later
#include "touch.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {
namespace {

double noise(double z) { return 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4); }

bool is_skin(const Vec4& linear) {
  Vec3 rgb{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double v = std::clamp(linear[c], 0.0, 1.0);
    rgb[c] = 255 * (v > 0.0031308 ? 1.055 * std::pow(v, 1 / 2.4) - 0.055 : 12.92 * v);
  }
  const auto [low, high] = std::ranges::minmax(rgb);
  return rgb[0] > 95 && rgb[1] > 40 && rgb[2] > 20 && high - low > 15 &&
         std::abs(rgb[0] - rgb[1]) > 15 && rgb[0] > rgb[1] && rgb[0] > rgb[2];
}

/// Calls f(index) for the pixels within `reach` of one, in the picture.
template <typename F>
void around(int width, int height, int x, int y, int reach, F f) {
  for (int v = std::max(y - reach, 0); v <= std::min(y + reach, height - 1); ++v)
    for (int u = std::max(x - reach, 0); u <= std::min(x + reach, width - 1); ++u)
      f(std::size_t(v) * std::size_t(width) + std::size_t(u));
}

constexpr int kTile = 8;

/// Tiles with at least four pixels in front that such tiles connect with the border.
std::vector<bool> reached_tiles(int across, int down, const std::vector<int>& in_front) {
  std::vector<bool> reached(in_front.size());
  std::vector<std::size_t> next;
  const auto reach = [&](std::size_t n) {
    if (reached[n] || in_front[n] < 4) return;
    reached[n] = true;
    next.push_back(n);
  };
  for (int y = 0; y < down; ++y)
    for (int x = 0; x < across; ++x)
      if (x == 0 || y == 0 || x + 1 == across || y + 1 == down)
        reach(std::size_t(y) * std::size_t(across) + std::size_t(x));
  while (!next.empty()) {
    const auto at = int(next.back());
    next.pop_back();
    around(across, down, at % across, at / across, 1, reach);
  }
  return reached;
}

}  // namespace

std::vector<TouchKind> compare(int width, int height, const std::vector<double>& depth,
                               const std::vector<double>& view, const Plane& layers) {
  std::vector<TouchKind> kinds(depth.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = layers.index(x, y);
      double nearest = 1e9;
      around(width, height, x, y, 1, [&](std::size_t n) {
        if (view[n] > 0) nearest = std::min(nearest, view[n]);
      });
      const double z = depth[at], gap = nearest - z;
      kinds[at].front = z > 0 && view[at] > 0 && gap > 0.02 + 4 * noise(z);
      kinds[at].maybe = z > 0 && (!(view[at] > 0) || gap > 0.004 + noise(z));
      kinds[at].skin = is_skin(layers.data[at]);
    }
  return kinds;
}

std::vector<TouchKind> grow(int width, int height, const std::vector<double>& depth,
                            const std::vector<TouchKind>& kinds) {
  std::vector<TouchKind> grown = kinds;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(width) + std::size_t(x);
      if (!kinds[at].maybe) continue;
      around(width, height, x, y, 2, [&](std::size_t n) {
        if (kinds[n].front && std::abs(depth[n] - depth[at]) < 0.02) grown[at].front = true;
      });
    }
  return grown;
}

TouchFound touch(const Camera& camera, const std::vector<double>& depth,
                 const std::vector<double>& view, const Plane& normals, const Plane& reflectance,
                 const std::vector<TouchKind>& kinds) {
  constexpr double kNear = 0.022, kAbove = 0.5;
  constexpr int kSide = 4;
  struct Sums {
    Vec3 place{}, color{};
    double weight = 0, colored = 0, distance = 0, pixels = 0;
  };
  const int across = (camera.width + kTile - 1) / kTile, down = (camera.height + kTile - 1) / kTile;
  std::vector<Sums> tiles(std::size_t(across) * std::size_t(down));
  double front = 0, measured = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const std::size_t at = reflectance.index(x, y);
      front += kinds[at].front;
      measured += depth[at] > 0;
      if (!kinds[at].front || !kinds[at].skin) continue;
      const auto point = [&](int u, int v, double z) {
        const Vec3 ray = camera.ray(u, v);
        return Vec3{z * ray[0], z * ray[1], z * ray[2]};
      };
      const Vec3 here = point(x, y, depth[at]);
      const auto stride = [&](double focal) {
        return int(std::max(std::ceil(kNear * std::abs(focal) / (depth[at] * kSide)), 1.0));
      };
      double nearest = kNear;
      Vec3 place{};
      std::size_t from = 0;
      for (int dy = -kSide; dy <= kSide; ++dy)
        for (int dx = -kSide; dx <= kSide; ++dx) {
          const int u = x + stride(camera.fx) * dx, v = y + stride(camera.fy) * dy;
          if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
          const std::size_t n = reflectance.index(u, v);
          if (!(view[n] > 0)) continue;
          const Vec3 there = point(u, v, view[n]);
          double square = 0;
          for (std::size_t c = 0; c < 3; ++c) square += (there[c] - here[c]) * (there[c] - here[c]);
          if (std::sqrt(square) >= nearest) continue;
          nearest = std::sqrt(square);
          place = there;
          from = n;
        }
      if (nearest >= kNear) continue;
      double above = 0;
      for (std::size_t c = 0; c < 3; ++c) above += (here[c] - place[c]) * normals.data[from][c];
      if (above <= kAbove * nearest) continue;
      const double weight = std::pow(1 - nearest / kNear, 2);
      Sums& sums = tiles[std::size_t(y / kTile) * std::size_t(across) + std::size_t(x / kTile)];
      const Vec4& r = reflectance.data[from];
      for (std::size_t c = 0; c < 3; ++c) {
        sums.place[c] += weight * place[c];
        if (r[3] > 0) sums.color[c] += weight * r[c];
      }
      sums.weight += weight;
      if (r[3] > 0) sums.colored += weight;
      sums.distance += weight * nearest;
      ++sums.pixels;
    }
  const std::vector<bool> arm = arm_tiles(camera.width, camera.height, kinds);
  Sums best;
  for (int y = 0; y < down; ++y)
    for (int x = 0; x < across; ++x) {
      if (!arm[std::size_t(y) * std::size_t(across) + std::size_t(x)]) continue;
      Sums sums;
      around(across, down, x, y, 1, [&](std::size_t n) {
        for (std::size_t c = 0; c < 3; ++c) {
          sums.place[c] += tiles[n].place[c];
          sums.color[c] += tiles[n].color[c];
        }
        sums.weight += tiles[n].weight;
        sums.colored += tiles[n].colored;
        sums.distance += tiles[n].distance;
        sums.pixels += tiles[n].pixels;
      });
      if (sums.weight > best.weight) best = sums;
    }
  TouchFound found;
  found.front = front / std::max(measured, 1.0);
  if (!(best.weight > 0)) return found;
  Vec3 mean{};
  for (std::size_t c = 0; c < 3; ++c) mean[c] = best.place[c] / best.weight;
  found.place = camera.to_world(mean);
  found.area = best.weight * mean[2] * mean[2] / std::abs(camera.fx * camera.fy);
  found.colored = best.colored > 0;
  for (std::size_t c = 0; c < 3 && found.colored; ++c)
    found.color[c] = best.color[c] / best.colored;
  found.distance = best.distance / best.weight;
  found.pixels = best.pixels;
  return found;
}

std::vector<bool> arm_tiles(int width, int height, const std::vector<TouchKind>& kinds) {
  const int across = (width + kTile - 1) / kTile, down = (height + kTile - 1) / kTile;
  const auto tile = [&](int x, int y) {
    return std::size_t(y) * std::size_t(across) + std::size_t(x);
  };
  std::vector<int> in_front(std::size_t(across) * std::size_t(down));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      in_front[tile(x / kTile, y / kTile)] +=
          kinds[std::size_t(y) * std::size_t(width) + std::size_t(x)].front;
  const std::vector<bool> reached = reached_tiles(across, down, in_front);
  std::vector<bool> arm(reached.size());
  for (int y = 0; y < down; ++y)
    for (int x = 0; x < across; ++x)
      around(across, down, x, y, 1, [&](std::size_t n) {
        if (reached[n]) arm[tile(x, y)] = true;
      });
  return arm;
}

std::vector<double> background(int width, int height, const std::vector<double>& depth,
                               const std::vector<TouchKind>& kinds) {
  std::vector<double> kept = depth;
  const std::vector<bool> arm = arm_tiles(width, height, kinds);
  const int across = (width + kTile - 1) / kTile;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (arm[std::size_t(y / kTile) * std::size_t(across) + std::size_t(x / kTile)])
        around(width, height, x, y, 2, [&](std::size_t n) {
          if (kinds[n].front) kept[std::size_t(y) * std::size_t(width) + std::size_t(x)] = 0;
        });
  return kept;
}

}  // namespace inverse::reference
