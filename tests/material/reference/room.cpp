// SPDX-License-Identifier: LGPL-2.1-or-later
#include "room.hpp"

#include <algorithm>
#include <cmath>

#include "tests/reference/camera/shadow.hpp"

namespace inverse::reference {
namespace {

constexpr double kProbeSpan = 1.1, kSceneReach = 1;
constexpr int kRays = 16, kSteps = 6;
constexpr double kBias = 0.01, kLift = 1.5, kMinShare = 0.01;

Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vec3 along(const Vec3& a, double t, const Vec3& b) {
  return {a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]};
}
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vec3 color_of(double shading, const Vec3& light,
              const std::optional<std::array<double, 2>>& slope) {
  Vec3 result;
  for (size_t c = 0; c < 3; ++c) {
    const double d = 0.5 * (1 - double(c));
    const double above = slope && shading > 0 ? (*slope)[0] * (std::log(shading) - (*slope)[1]) : 0;
    result[c] = shading * std::exp(std::clamp(above / 2, -20.0, 20.0) * 2 * d) * light[c];
  }
  return result;
}

}  // namespace

RayHit look_through(const std::vector<Triangle>& triangles, const Vec3& ray, double nearest) {
  RayHit hit;
  for (size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    if (std::min({a[2], b[2], c[2]}) <= nearest) continue;
    // Möller and Trumbore (1997), from the origin.
    const Vec3 u = minus(b, a), v = minus(c, a), p = cross(ray, v);
    const double area = dot(u, p);
    if (area == 0) continue;
    const Vec3 from{-a[0], -a[1], -a[2]};
    const double first = dot(from, p) / area;
    const Vec3 q = cross(from, u);
    const double second = dot(ray, q) / area, depth = dot(v, q) / area;  // ray[2] is 1
    if (first < 0 || second < 0 || first + second > 1 || depth <= 0) continue;
    if (hit.triangle < 0 || depth < hit.depth)
      hit = {int(t), depth, {1 - first - second, first, second}};
  }
  return hit;
}

double light_on(const Beam& beam, const Vec3& normal) {
  return beam.flux * std::max(dot(beam.mean, normal), 0.0);
}

Probe probe(const Volume& volume, const RoomObject& object, const std::vector<Beam>& beams,
            size_t lamps, int index) {
  const int at[] = {index % kProbeSide, index / kProbeSide % kProbeSide,
                    index / (kProbeSide * kProbeSide)};
  Vec3 off;
  for (size_t c = 0; c < 3; ++c)
    off[c] = (2.0 * at[c] / (kProbeSide - 1) - 1) * kProbeSpan * object.radius;
  const double away = std::sqrt(dot(off, off));
  if (lit_share(volume, object.center, {off[0] / away, off[1] / away, off[2] / away}, away, 0) <=
      0.5)
    return {};
  std::array<double, 8> lit;
  lit.fill(1);
  for (size_t k = 0; k < lamps; ++k)
    lit[k] =
        lit_share(volume, along(object.center, 1, off), beams[k].z, kSceneReach, beams[k].radius);
  return lit;
}

double reached_share(const std::vector<Probe>& probes, const RoomObject& object,
                     const std::vector<Beam>& beams, size_t lamps, const Vec3& place,
                     const Vec3& normal) {
  std::array<double, 8> lit{};
  double total = 0;
  int low[3];
  double part[3];
  for (size_t c = 0; c < 3; ++c) {
    const double at = std::clamp(
        ((place[c] - object.center[c]) / (kProbeSpan * object.radius) + 1) / 2 * (kProbeSide - 1),
        0.0, kProbeSide - 1.001);
    low[c] = int(at);
    part[c] = at - low[c];
  }
  for (int n = 0; n < 8; ++n) {
    double weight = 1;
    int index = 0;
    for (int c = 2; c >= 0; --c) {
      const int step = n >> c & 1;
      weight *= step ? part[c] : 1 - part[c];
      index = index * kProbeSide + low[c] + step;
    }
    const Probe& p = probes[size_t(index)];
    if (!p) continue;
    total += weight;
    for (size_t k = 0; k < 8; ++k) lit[k] += weight * (*p)[k];
  }
  if (total < 1e-3) return 1;
  double all = 0, reached = 0;
  for (size_t k = 0; k < beams.size(); ++k) {
    const double light = light_on(beams[k], normal);
    all += light;
    reached += light * (k < lamps ? lit[k] / total : 1);
  }
  return all > 0 ? reached / all : 1;
}

double hidden_share(const Plane& maps, const RoomObject& object, const std::vector<Beam>& beams,
                    double softness, const Volume& volume, const Vec3& place, const Vec3& normal) {
  double all = 0, hidden = 0;
  for (size_t k = 0; k < beams.size(); ++k) {
    const Beam& beam = beams[k];
    const double light = light_on(beam, normal);
    all += light;
    if (!(light > 0)) continue;
    Vec3 off = minus(place, object.center);
    for (double& v : off) v /= object.radius;
    const double u = dot(off, beam.x), v = dot(off, beam.y), height = dot(off, beam.z);
    if (height > 1) continue;
    const double low = std::max(height + kBias, -1.0), size = (1 - low) / kSteps;
    double share = 0;
    for (int i = 0; i < kRays; ++i) {
      double covered = 0;
      for (int n = 0; n < kSteps; ++n) {
        const double from = low + n * size, to = from + size;
        const double off_axis = std::sqrt((i + 0.5) / kRays) *
                                (beam.radius * ((from + to) / 2 - height) + softness),
                     angle = 2.399963 * i;
        const double x = (u + off_axis * std::cos(angle)) * kMapRadius + kMapPixels / 2.0,
                     y = -(v + off_axis * std::sin(angle)) * kMapRadius + kMapPixels / 2.0;
        if (!(x >= 0 && y >= 0 && x < kMapPixels && y < kMapPixels)) continue;
        const int column = int(x) + kMapPixels * (int(k) % kMapRow),
                  line = int(y) + kMapPixels * (int(k) / kMapRow);
        const Vec4 &front = maps.at(column, line),
                   &back = maps.at(column, line + kMapLines * kMapPixels);
        if (front[0] > from * kMapRadius && -back[0] < to * kMapRadius)
          covered = std::max(covered, front[1]);
      }
      share += covered / kRays;
    }
    if (share < kMinShare) continue;
    hidden += light * share *
              lit_share(volume, along(place, kLift * volume.voxel, normal), beam.z,
                        std::max(-height, 0.0) * object.radius, 0);
  }
  return all > 0 ? std::min(hidden / all, 1.0) : 0;
}

Vec3 product(const Vec4& layers, const Vec3& light,
             const std::optional<std::array<double, 2>>& slope) {
  Vec3 result = color_of(layers[3], light, slope);
  for (size_t c = 0; c < 3; ++c) result[c] *= layers[c];
  return result;
}

RoomPixel inserted(const RoomPixel& pixel, const Vec4& object, double albedo, double hidden) {
  RoomPixel result = pixel;
  result.intrinsic[3] *= 1 - hidden;
  if (!(object[3] > 0)) return result;
  const double bare = 1 - object[3],
               shading = (object[0] + object[1] + object[2]) / 3 / object[3] / albedo;
  const auto over = [&](const Vec4& below, const Vec3& light) {
    const Vec3 behind = product(below, light, pixel.slope);
    Vec4 layers;
    layers[3] = object[3] * shading + bare * below[3];
    const Vec3 color = color_of(layers[3], light, pixel.slope);
    for (size_t c = 0; c < 3; ++c)
      layers[c] = color[c] > 0 ? (object[c] + bare * behind[c]) / color[c] : 0;
    return layers;
  };
  for (size_t c = 0; c < 3; ++c) result.frame[c] = object[c] + bare * pixel.frame[c];
  result.model = over(pixel.model, pixel.model_light);
  result.intrinsic = over(result.intrinsic, pixel.light);
  return result;
}

}  // namespace inverse::reference
