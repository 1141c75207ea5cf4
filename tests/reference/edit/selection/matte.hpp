// SPDX-License-Identifier: LGPL-2.1-or-later
// The matte of a selection of cells or pixels, with soft edges that follow the frame. Double
// precision.
//
// Cells are core if they and their neighbors are selected, outside if none of these is, and border
// cells if the selection ends within two cells. At a border cell, F is the mean light of core cells
// and B that of outside cells around it: up to four cells away, weighted by a Gaussian of 3 cells.
// Between cells they are interpolated bilinearly. Light I of a pixel at the border is a mixture, so
//
//   t = (I - B).(F - B) / |F - B|^2             without the first and the last tenth
//   k = |F - B|^2 / (|F - B|^2 + (.15 |F + B| / 2)^2)
//   alpha = k t + (1 - k) a                      a: alpha of the selection
//
// and what a pixel of reflectance R is in front of has the reflectance R B / I.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

struct MatteSpec {
  bool soft = true, invert = false;
  enum { replace, add, subtract, intersect } combine = replace;
};

/// Of every pixel: the matte, and the reflectance of what is behind it minus its own. `alpha` and
/// `region` are of cells; or of pixels: `selection`, with the region that it covers. `mask` came
/// in.
Plane matte(const Plane& frame, const Plane& reflectance, int side,
            const std::vector<double>& alpha, const std::vector<uint32_t>& region,
            const Plane* selection, const Plane* mask, const MatteSpec& spec);
/// Cells that a selection of pixels covers more than half.
std::vector<uint32_t> covered_cells(const Plane& selection, int side);

}  // namespace inverse::reference
