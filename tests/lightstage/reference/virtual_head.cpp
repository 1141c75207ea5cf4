// SPDX-License-Identifier: LGPL-2.1-or-later
#include "virtual_head.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/reference/random.hpp"

namespace inverse::reference {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3 along(const Vec3& a, const Vec3& b, double t) {  // a + t b
  return {a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]};
}
double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
Vec3 normalized(const Vec3& a) {
  const double l = length(a);
  return {a[0] / l, a[1] / l, a[2] / l};
}
double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Vec3 to_ball(const HeadSolid& solid, const Vec3& v) {
  return {dot(solid.rows[0], v), dot(solid.rows[1], v), dot(solid.rows[2], v)};
}

/// k0 (k0 - 1) / |Mᵀ M p|
double distance_to(const HeadSolid& solid, const Vec3& at) {
  const Vec3 q = to_ball(solid, along(at, solid.center, -1));
  Vec3 gradient{};
  for (std::size_t i = 0; i < 3; ++i) gradient = along(gradient, solid.rows[i], q[i]);
  return length(q) * (length(q) - 1) / std::max(length(gradient), 1e-9);
}

double smooth_min(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k / 4;
}

/// Random values in [-1, 1) at integer points, smoothly interpolated.
double noise(const Vec3& p) {
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<std::uint32_t, 3> at;
    for (std::size_t c = 0; c < 3; ++c) {
      const double start = std::floor(p[c]), f = smoothstep(0, 1, p[c] - start);
      const int step = (corner >> c) & 1;
      weight *= step ? f : 1 - f;
      at[c] = static_cast<std::uint32_t>(static_cast<std::int32_t>(start) + step);
    }
    sum += weight * (static_cast<double>(pcg3d(at[0], at[1], at[2])[0] >> 8) / 8388608 - 1);
  }
  return sum;
}

Vec3 mix(const Vec3& a, const Vec3& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

/// White of an eye that faces +z, its iris and its pupil.
Vec3 eye_color(const Vec3& out) {
  const double across = std::hypot(out[0], out[1]);
  const Vec3 white{.72, .68, .65}, iris{.10, .16, .17}, pupil{.01, .01, .01};
  if (out[2] <= 0) return white;
  return mix(mix(white, iris, 1 - smoothstep(.41, .47, across)), pupil,
             1 - smoothstep(.17, .21, across));
}

}  // namespace

Vec3 HeadCamera::eye() const {
  return {distance * std::sin(turn), center, distance * std::cos(turn)};
}

double head_distance(const Head& head, const Vec3& at) {
  double d = 1e9;
  for (const HeadSolid& solid : head.solids) {
    const double own = distance_to(solid, at);
    d = solid.carving ? -smooth_min(-d, own, solid.blend) : smooth_min(d, own, solid.blend);
  }
  return d;
}

std::optional<HeadPoint> see_head(const Head& head, const HeadCamera& camera, int width, int height,
                                  int x, int y) {
  const double scale = camera.height / height;
  const double right = (x + .5 - .5 * width) * scale, up = -(y + .5 - .5 * height) * scale;
  const Vec3 eye = camera.eye();
  const Vec3 to_axis{-eye[0], 0, -eye[2]},
      sideways{std::cos(camera.turn), 0, -std::sin(camera.turn)};
  const Vec3 ray = normalized(along(along(to_axis, sideways, right), {0, 1, 0}, up));
  // The first point of distance 0, in short steps.
  double t = camera.distance - 2, d = 1;
  for (int i = 0; i < 1000 && t < camera.distance + 2; ++i) {
    d = head_distance(head, along(eye, ray, t));
    if (d <= 1e-4) break;
    t += .5 * d;
  }
  if (d > 4e-3 || t >= camera.distance + 2) return std::nullopt;
  HeadPoint point{};
  point.position = along(eye, ray, t);
  for (std::size_t c = 0; c < 3; ++c) {
    Vec3 step{};
    step[c] = 1e-3;
    point.normal[c] = head_distance(head, along(point.position, step, 1)) -
                      head_distance(head, along(point.position, step, -1));
  }
  point.normal = normalized(point.normal);
  // Materials by 2^(-400 distance) of their solids.
  double all = 0;
  for (const HeadSolid& solid : head.solids) {
    if (solid.carving) continue;
    const double weight =
        std::exp2(-400 * std::clamp(distance_to(solid, point.position), 0.0, .25));
    const HeadMaterial& m = head.materials[static_cast<std::size_t>(solid.material)];
    const bool eye_ball = solid.material == 3, hair = solid.material == 2;
    const Vec3& p = point.position;
    const Vec3 color = eye_ball ? eye_color(to_ball(solid, along(p, solid.center, -1))) : m.albedo;
    const Vec3 u =
        hair ? Vec3{14 * p[0], 3 * p[1], 14 * p[2]}
             : Vec3{m.texture_scale * p[0], m.texture_scale * p[1], m.texture_scale * p[2]};
    const auto octave = [&](double f) { return noise({f * u[0], f * u[1], f * u[2]}); };
    const double texture = 1 + m.texture * (octave(1) + .5 * octave(2.7) + .35 * octave(6.1));
    point.albedo = along(point.albedo, color, weight * texture);
    point.roughness += weight * m.roughness;
    point.f0 += weight * m.f0;
    all += weight;
  }
  for (double& c : point.albedo) c = std::max(c / all, 0.0);
  point.roughness /= all;
  point.f0 /= all;
  return point;
}

Vec3 shade_head(const Head& head, const HeadPoint& point, const Vec3& eye, const Vec3& light) {
  const double nl = dot(point.normal, light);
  if (nl <= 0) return {};
  double open = 1;
  for (const HeadSolid& solid : head.solids) {
    const Vec3 q = to_ball(solid, along(point.position, solid.center, -1)),
               l = to_ball(solid, light);
    const double t = -dot(q, l) / dot(l, l);
    if (solid.carving || t <= 0 || dot(q, q) <= 1) continue;
    const double nearest = length(along(q, l, t));
    open *= 1 - smoothstep(-1, 1, (1 - nearest) * solid.radius / (.035 * t + .004));
  }
  const Vec3 v = normalized(along(eye, point.position, -1)), h = normalized(along(light, v, 1));
  const double nv = std::max(dot(point.normal, v), 1e-3), nh = std::max(dot(point.normal, h), 0.0);
  const double vh = std::max(dot(v, h), 0.0), cosine = std::max(nl, 1e-4);
  const double a2 = std::pow(point.roughness, 4);  // GGX with alpha = roughness²
  const double d = a2 / (kPi * std::pow(nh * nh * (a2 - 1) + 1, 2));
  const auto smith = [&](double c) { return 2 * c / (c + std::sqrt(a2 + (1 - a2) * c * c)); };
  // Smith's masking and shadowing, correlated by height (Heitz 2014).
  const double lambda_v = nv / smith(nv) * 2 - nv, lambda_l = cosine / smith(cosine) * 2 - cosine;
  const double g = 2 * cosine * nv / (cosine * lambda_v + nv * lambda_l);
  const double f = point.f0 + (1 - point.f0) * std::pow(1 - vh, 5);
  const double specular = kPi * d * g * f / (4 * cosine * nv);
  Vec3 value;
  for (std::size_t c = 0; c < 3; ++c) value[c] = (point.albedo[c] + specular) * cosine * open;
  return value;
}

Plane take_picture(const Plane& light, const CameraShot& shot) {
  Plane picture(light.width, light.height);
  for (int y = 0; y < light.height; ++y)
    for (int x = 0; x < light.width; ++x) {
      const double rows = std::max(light.height, 2) - 1;
      const double from = std::clamp(x - shot.sway * (1 - y / rows), 0.0, light.width - 1.0);
      const int left = static_cast<int>(from), right = std::min(left + 1, light.width - 1);
      const double f = from - left;
      const auto index = static_cast<std::uint32_t>(light.index(x, y));
      const auto words = pcg3d(index, shot.frame, shot.seed);
      const auto more = pcg3d(words[0], words[1], words[2]);
      const auto uniform = [](std::uint32_t word) { return ((word >> 8) + .5) / 16777216; };
      const auto radius = [&](std::uint32_t word) {
        return std::sqrt(-2 * std::log(uniform(word)));
      };
      const Vec3 normal{radius(words[0]) * std::cos(2 * kPi * uniform(words[1])),
                        radius(words[0]) * std::sin(2 * kPi * uniform(words[1])),
                        radius(more[0]) * std::cos(2 * kPi * uniform(more[1]))};
      for (std::size_t c = 0; c < 3; ++c) {
        const double v = shot.gain * (light.at(left, y)[c] * (1 - f) + light.at(right, y)[c] * f);
        const double sigma = shot.noise * std::sqrt(.9 * std::max(v, 0.0) + .1);
        picture.at(x, y)[c] = v + sigma * normal[c];
      }
      picture.at(x, y)[3] = 1;
    }
  return picture;
}

}  // namespace inverse::reference
