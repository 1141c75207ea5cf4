// SPDX-License-Identifier: LGPL-2.1-or-later
// Procedural objects, in families with a trait each that says which of them are kept for tests.
#pragma once

#include <vector>

#include "grid.hpp"
#include "random.hpp"

namespace inverse::lime {

/// Families and their traits:
///   superquadric  the exponent along the axis, 0.15 … 2; held out: 0.5 … 0.75
///   blob          the degree of its spherical harmonics, 2 … 7; held out: 4
///   lathe         control points of the profile, 4 … 9; held out: 6
///   tube          turns of the curve around its ring, 0 (torus), 2 … 6; held out: 4
///   displaced     frequency of the displacement, 2.5 … 9 per unit; held out: 4.5 … 6
enum class Family { superquadric, blob, lathe, tube, displaced };
constexpr int kFamilies = 5;

/// Whether objects with this trait are only in the test split.
bool is_held_out(Family family, float trait);

/// One object of one to three parts; bounding sphere of radius 1 around the origin.
struct Object {
  std::vector<Grid> parts;
  Family family;         ///< Of the first and largest part.
  float trait = 0;       ///< Of the first part.
  bool upright = false;  ///< Whether +z is its natural up (lathes).
};

/// Draws an object all of whose parts (and the forms that displaced ones start from) are held out,
/// or none.
Object make_object(Random& random, bool held_out);

}  // namespace inverse::lime
