// SPDX-License-Identifier: LGPL-2.1-or-later
// What is behind the object.
#pragma once

#include <vector>

#include "environment.hpp"
#include "random.hpp"

namespace inverse::lime {

/// size × size pixels, linear, 0 … 1: noise, stripes, checks, clutter, a table before a wall, a
/// plain gradient, or the environment itself as the camera would see it.
std::vector<Vec> make_background(Random& random, int size, const Environment& map);

/// A wall, often with a table before it, lit unevenly; every sixth time black.
std::vector<Vec> make_plain_background(Random& random, int size);

/// Sharp-edged marks over size × size albedos, as letters, labels and stripes are: patches of one
/// to three inks and of something white; a third of the objects becomes white beneath them.
void print_marks(Random& random, int size, std::vector<Vec>& pixels);

}  // namespace inverse::lime
