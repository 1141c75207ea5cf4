// SPDX-License-Identifier: LGPL-2.1-or-later
// The virtual head and its camera (kernels/lightstage/virtual_stage), in double precision.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// An ellipsoid that is joined to the head or subtracted from it. `rows` map an offset from the
/// center to the unit ball.
struct HeadSolid {
  std::array<Vec3, 3> rows;
  Vec3 center;
  double radius, blend;
  bool carving;
  int material;
};
struct HeadMaterial {
  Vec3 albedo;
  double roughness, f0, texture, texture_scale;
};
struct Head {
  std::vector<HeadSolid> solids;
  std::vector<HeadMaterial> materials;
};
struct HeadCamera {
  double turn, distance, height, center;
  Vec3 eye() const;
};

double head_distance(const Head& head, const Vec3& at);

struct HeadPoint {
  Vec3 position, normal, albedo;
  double roughness, f0;
};
/// The surface in a pixel; empty if the pixel misses the head.
std::optional<HeadPoint> see_head(const Head& head, const HeadCamera& camera, int width, int height,
                                  int x, int y);
/// Its radiance seen from `eye` under a white light of irradiance pi from this direction.
Vec3 shade_head(const Head& head, const HeadPoint& point, const Vec3& eye, const Vec3& light);

struct CameraShot {
  double sway, gain, noise;
  std::uint32_t seed, frame;
};
Plane take_picture(const Plane& light, const CameraShot& shot);

}  // namespace inverse::reference
