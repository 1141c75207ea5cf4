// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the kernels of the matte (matte.hpp; tests/reference/edit/selection/matte.hpp has the equations).
#include "image/finite.glsl"

// Classes of cells. Core: it and its neighbors are selected; outside: none of them is. kBorder is added where the selection ends
// within two cells.
const uint kMixed = 0u, kCore = 1u, kOutside = 2u, kBorder = 4u;
const int kReach = 4;        // cells around a border cell whose light is averaged
const float kSigma = 3.0;    // cells
const float kApart = 0.15;   // difference of the two sides, relative to their mean, from which on light separates them
const float kMargin = 0.1;   // of alpha that is rounded to 0 and to 1
