// SPDX-License-Identifier: LGPL-2.1-or-later
// Visibility of triangles at given points, by brute force.
#pragma once

#include <array>
#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// Corners in pixels, y down; z towards the camera.
using Triangle = std::array<Vec3, 3>;

struct Hit {
  int triangle = -1;  ///< the nearest one; −1: none
  double depth = 0;
  double margin = 1e300;  ///< distance of the point to the nearest edge of any triangle, pixels
};

/// The visible triangle at a point; triangles without area have no inside.
Hit look(const std::vector<Triangle>& triangles, double x, double y);

/// The eight points of a pixel, from its upper left corner.
extern const std::array<std::array<double, 2>, 8> kSamplePoints;

/// Light of a uniform sky that a patch of `area`, at height h and distance r along the ground,
/// blocks from a point of the ground: the form factor of two parallel patches, or of a disc if they
/// are close.
double hidden_by(double area, double height, double distance);

/// The grids around an object of radius 1 on the ground, x right, rows towards the camera: its
/// underside from -1 to 1, and the blocked light from -2 to 2.
constexpr int kUnderside = 32, kGround = 64;

/// Share of a uniform sky's light that an object blocks from the points of the ground (x), faded to
/// 0 at distance 2. underside: depth from below in cells (x), coverage (y); ground: its height;
/// soft: added to heights.
Plane hidden_light(const Plane& underside, double ground, double soft);

/// Position of the ground in the image.
struct GroundView {
  double x, y;      ///< the object's center, pixels
  double radius;    ///< of the object, pixels
  double ground;    ///< height of the ground as it is seen, in radii from the center up
  double sine;      ///< of the camera's elevation
  double yaw;       ///< of the object, radians
  double strength;  ///< of the shadow
};
/// Shadow at a point of the image.
double darkness(const Plane& hidden, const GroundView& view, double x, double y);
/// Composes an object (RGB times coverage, coverage) and its shadow, black with the missing light
/// as opacity, over a pixel (RGB, alpha).
Vec4 over(const Vec4& object, double dark, const Vec4& below);

}  // namespace inverse::reference
