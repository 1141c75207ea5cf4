// What of triangles is seen at given points, by brute force.
#pragma once

#include <array>
#include <vector>

#include "plane.hpp"

namespace inverse::reference {

/// Corners in pixels, y down; z towards the camera.
using Triangle = std::array<Vec3, 3>;

struct Hit {
  int triangle = -1;  ///< the nearest one; −1: none
  double depth = 0;
  double margin = 1e300;  ///< how far the point is from the next edge of any triangle, in pixels
};

/// What is seen at a point; triangles without area have no inside.
Hit look(const std::vector<Triangle>& triangles, double x, double y);

/// The eight points of a pixel, from its upper left corner.
extern const std::array<std::array<double, 2>, 8> kSamplePoints;

/// The light of an even sky that a patch of `area`, at height h and distance r along the ground,
/// hides from a point of the ground: the form factor of two patches that face each other, and of a
/// disc where they are near.
double hidden_by(double area, double height, double distance);

}  // namespace inverse::reference
