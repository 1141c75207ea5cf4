// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_light.hpp"

#include <algorithm>
#include <cmath>

#include "tests/reference/camera/shadow.hpp"

namespace inverse::reference {
namespace {

constexpr double kLift = 1.5, kClear = 2, kSunReach = 12;  // voxels, voxels, meters
constexpr double kMinReach = 1, kMaxReach = 3, kNoiseReach = 1.5, kAlike = 0.3, kJump = 0.03;
constexpr int kStep = 2;  // pixels

/// Of the depth of a sensor, meters.
double noise_at(double depth) { return 0.0012 + 0.0019 * (depth - 0.4) * (depth - 0.4); }

/// 0 where it is not known.
Vec3 normal_at(const Volume& volume, const Vec3& place, double reach) {
  Vec3 slope{};
  for (size_t c = 0; c < 3; ++c) {
    Vec3 low = place, high = place;
    low[c] -= reach, high[c] += reach;
    double below = 0, above = 0;
    if (!volume.distance_at(low, below) || !volume.distance_at(high, above)) return {};
    slope[c] = above - below;
  }
  const double length = std::sqrt(dot(slope, slope));
  if (length > 0)
    for (double& v : slope) v /= length;
  return slope;
}

double shadow_of(const Volume& volume, const Surface& surface, const SceneLamp& lamp, double lift) {
  const bool sun = lamp.kind == SceneLamp::Kind::directional;
  Vec3 from, to;
  for (size_t c = 0; c < 3; ++c) {
    from[c] = surface.place[c] + lift * surface.normal[c];
    to[c] = sun ? -lamp.axis[c] : lamp.place[c] - from[c];
  }
  if (sun) return lit_share(volume, from, to, kSunReach, 0);
  const double way = std::sqrt(dot(to, to));
  const double reach = way - std::max(lamp.radius, kClear * volume.voxel);
  if (!(reach > 0)) return 1;
  for (double& v : to) v /= way;
  return lit_share(volume, from, to, reach, lamp.radius / way);
}

/// What a pixel sees, in the world; depth 0: nothing.
struct Sight {
  Surface surface;
  double depth = 0;
};

Sight sight(const Camera& camera, int x, int y, const Rgba& seen) {
  const Vec3 normal{seen[0], seen[1], seen[2]};
  if (!(seen[3] > 0 && seen[3] < 65504 && dot(normal, normal) > 0.5)) return {};
  Vec3 at = camera.ray(x, y);
  for (double& v : at) v *= seen[3];
  return {{camera.to_world(at), camera.turned(normal)}, seen[3]};
}

struct Shadowed {
  Vec3 normal{};
  std::vector<double> shares;  // a lamp
  double depth = 0;
};

Shadowed shadowed(const Sight& sight, const std::vector<SceneLamp>& lamps, const Volume& volume,
                  bool shadows) {
  Surface lit = sight.surface;
  const double reach = volume.voxel * std::clamp(kNoiseReach * noise_at(sight.depth) / volume.voxel,
                                                 kMinReach, kMaxReach);
  const Vec3 smooth = normal_at(volume, lit.place, reach);
  if (dot(smooth, lit.normal) > kAlike) lit.normal = smooth;
  Shadowed result{lit.normal, {}, sight.depth};
  for (const SceneLamp& lamp : lamps)
    result.shares.push_back(
        shadows && light_on(lit, {lamp}) != Rgb{}
            ? shadow_of(volume, lit, lamp, std::max(kLift * volume.voxel, reach))
            : 1);
  return result;
}

}  // namespace

std::vector<Rgb> scene_light(const Camera& camera, const Plane& surface,
                             const std::vector<SceneLamp>& lamps, const Volume& volume,
                             bool shadows) {
  std::vector<Shadowed> known(surface.size());
  for (int y = 0; y < camera.height; y += kStep)
    for (int x = 0; x < camera.width; x += kStep) {
      const Sight there = sight(camera, x, y, surface.at(x, y));
      if (there.depth > 0) known[surface.index(x, y)] = shadowed(there, lamps, volume, shadows);
    }
  std::vector<Rgb> result(surface.size());
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Sight here = sight(camera, x, y, surface.at(x, y));
      if (!(here.depth > 0)) continue;
      // All around it, then those of its surface alone, if there are some.
      for (const bool same_only : {false, true}) {
        Surface lit{here.surface.place, {}};
        std::vector<double> shares(lamps.size());
        double total = 0;
        for (int v = y - kStep + 1; v < y + kStep; ++v)
          for (int u = x - kStep + 1; u < x + kStep; ++u) {
            if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) continue;
            const Shadowed& other = known[surface.index(u, v)];
            const bool same = dot(other.normal, here.surface.normal) > kAlike &&
                              std::abs(other.depth - here.depth) <= kJump * here.depth;
            if (!(other.depth > 0) || (same_only && !same)) continue;
            const double weight =
                (1 - std::abs(u - x) / double(kStep)) * (1 - std::abs(v - y) / double(kStep));
            total += weight;
            for (size_t c = 0; c < 3; ++c)
              lit.normal[c] += weight * (same ? other.normal[c] : here.surface.normal[c]);
            for (size_t k = 0; k < lamps.size(); ++k) shares[k] += weight * other.shares[k];
          }
        if (same_only && total == 0) break;
        const double length = std::sqrt(dot(lit.normal, lit.normal));
        for (size_t c = 0; c < 3; ++c)
          lit.normal[c] = total > 0 ? lit.normal[c] / length : here.surface.normal[c];
        Rgb sum{};
        for (size_t k = 0; k < lamps.size(); ++k) {
          const Rgb added = light_on(lit, {lamps[k]});
          for (size_t c = 0; c < 3; ++c) sum[c] += added[c] * (total > 0 ? shares[k] / total : 1);
        }
        for (double& channel : sum) channel = std::min(channel, 65504.0);
        result[surface.index(x, y)] = sum;
      }
    }
  return result;
}

}  // namespace inverse::reference
