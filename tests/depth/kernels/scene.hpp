// SPDX-License-Identifier: LGPL-2.1-or-later
// What a depth camera without noise sees of a corner of a room with a ball and a box, or of a bare
// wall with paint on it.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/reference/camera/volume.hpp"

namespace inverse::testing {

using reference::Camera;
using reference::Vec3;

/// Depth along the optical axis and ln reflectance of what a ray from `origin` hits first.
struct Hit {
  double along = 1e9;
  Vec3 color{};
};

enum class Scene { room, wall };

inline Hit trace(Scene scene, const Vec3& origin, const Vec3& ray) {
  Hit hit;
  const auto take = [&](double t, const Vec3& color) {
    if (t > 1e-6 && t < hit.along) hit = {t, color};
  };
  const auto checker = [](double a, double b) {
    return (int(std::floor(a / 0.25)) + int(std::floor(b / 0.25))) % 2 ? -1.6 : -0.4;
  };
  const auto at = [&](double t, size_t c) { return origin[c] + t * ray[c]; };
  if (scene == Scene::wall) {
    const double t = (2.0 - origin[2]) / ray[2];
    const double v = -1 + 0.5 * std::sin(9 * at(t, 0)) * std::cos(7 * at(t, 1) + 2 * at(t, 0));
    take(t, {v, v, v});
    return hit;
  }
  if (const double t = (1.0 - origin[1]) / ray[1]; t > 0) {
    const double v = checker(at(t, 0), at(t, 2));
    take(t, {v, v - 0.2, v - 0.5});
  }
  if (const double t = (2.6 - origin[2]) / ray[2]; t > 0) take(t, {-0.3, -0.35, -0.5});
  if (const double t = (-1.4 - origin[0]) / ray[0]; t > 0) take(t, {-0.5, -1.2, -1.0});
  const Vec3 center{0.3, 0.65, 1.7};
  const double radius = 0.35;
  Vec3 from;
  for (size_t c = 0; c < 3; ++c) from[c] = origin[c] - center[c];
  const double a = reference::dot(ray, ray), b = reference::dot(from, ray),
               d = b * b - a * (reference::dot(from, from) - radius * radius);
  if (d > 0) take((-b - std::sqrt(d)) / a, {-1.9, -0.6, -0.9});
  const Vec3 low{-0.9, 0.55, 1.5}, high{-0.4, 1.0, 2.0};
  double enter = 0, leave = 1e9;
  for (size_t c = 0; c < 3; ++c) {
    const double s = (low[c] - origin[c]) / ray[c], t = (high[c] - origin[c]) / ray[c];
    enter = std::max(enter, std::min(s, t));
    leave = std::min(leave, std::max(s, t));
  }
  if (enter < leave) take(enter, {-0.7, -0.8, -2.2});
  return hit;
}

/// A camera that looks from `place` at `target`.
inline Camera camera_at(int width, int height, const Vec3& place, const Vec3& target) {
  const auto unit = [](Vec3 v) {
    const double length = std::sqrt(reference::dot(v, v));
    for (double& x : v) x /= length;
    return v;
  };
  const auto cross = [](const Vec3& a, const Vec3& b) {
    return Vec3{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const Vec3 z = unit({target[0] - place[0], target[1] - place[1], target[2] - place[2]});
  const Vec3 x = unit(cross({0, 1, 0}, z)), y = cross(z, x);
  // The quaternion of the matrix with these columns; cameras look roughly along z, so w is large.
  const double w = 0.5 * std::sqrt(1 + x[0] + y[1] + z[2]);
  return {0.9 * width,
          0.9 * width,
          0.5 * (width - 1),
          0.5 * (height - 1),
          width,
          height,
          {(y[2] - z[1]) / (4 * w), (z[0] - x[2]) / (4 * w), (x[1] - y[0]) / (4 * w), w},
          place};
}

struct Seen {
  std::vector<double> depth;  ///< meters, along the optical axis
  reference::Plane layers;    ///< mean reflectance of a pixel, and a shading of 1
};

inline Seen look(const Camera& camera, Scene scene = Scene::room) {
  Seen seen{std::vector<double>(size_t(camera.width) * size_t(camera.height)),
            reference::Plane(camera.width, camera.height)};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const size_t n = seen.layers.index(x, y);
      const Hit hit = trace(scene, camera.place, camera.turned(camera.ray(x, y)));
      seen.depth[n] = hit.along < 1e9 ? hit.along : 0;
      reference::Vec4& mean = seen.layers.data[n];
      mean[3] = 1;
      for (int i = 0; i < 9; ++i) {
        const int dx = i % 3 - 1, dy = i / 3 - 1;
        const Vec3 ray = camera.ray(x + dx / 3.0, y + dy / 3.0);
        const Vec3 color = trace(scene, camera.place, camera.turned(ray)).color;
        for (size_t c = 0; c < 3; ++c) mean[c] += std::exp(color[c]) / 9;
      }
    }
  return seen;
}

}  // namespace inverse::testing
