// SPDX-License-Identifier: LGPL-2.1-or-later
#include "scene_light.hpp"

#include <algorithm>
#include <cmath>

#include "tests/reference/volume/shadow.hpp"

namespace inverse::reference {
namespace {

constexpr double kLift = 1.5, kClear = 2, kSunReach = 12;  // voxels, voxels, meters
constexpr double kMinReach = 1, kMaxReach = 3, kNoiseReach = 1.5, kAlike = 0.3;

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

}  // namespace

Rgb scene_light(const Camera& camera, int x, int y, const Rgba& surface,
                const std::vector<SceneLamp>& lamps, const Volume& volume, bool shadows) {
  Rgb sum{};
  const double depth = surface[3];
  const Vec3 seen{surface[0], surface[1], surface[2]};
  if (!(depth > 0 && depth < 65504 && dot(seen, seen) > 0.5)) return sum;
  Vec3 at = camera.ray(x, y);
  for (double& v : at) v *= depth;
  Surface lit{camera.to_world(at), camera.turned(seen)};
  const double reach =
      volume.voxel * std::clamp(kNoiseReach * noise_at(depth) / volume.voxel, kMinReach, kMaxReach);
  const Vec3 smooth = normal_at(volume, lit.place, reach);
  if (dot(smooth, lit.normal) > kAlike) lit.normal = smooth;
  const double lift = std::max(kLift * volume.voxel, reach);
  for (const SceneLamp& lamp : lamps) {
    const Rgb added = light_on(lit, {lamp});
    if (added == Rgb{}) continue;
    const double share = shadows ? shadow_of(volume, lit, lamp, lift) : 1;
    for (size_t c = 0; c < 3; ++c) sum[c] += share * added[c];
  }
  for (double& v : sum) v = std::min(v, 65504.0);
  return sum;
}

}  // namespace inverse::reference
