// SPDX-License-Identifier: LGPL-2.1-or-later
// Tone curves on shading in double precision: the specification of kernels/edit/tone.
#pragma once
#include <vector>

#include "edit.hpp"

namespace inverse::reference {

struct TonePoint {
  double x, y;
};

/// The monotone cubic through the points (Fritsch and Carlson 1980), which ascend in x, at `x`;
/// beyond them its tangents.
double tone_curve(const std::vector<TonePoint>& points, double x);

/// Mean of log2 S over the sample of a frame of this size; `matte` has a value for each pixel, or
/// none. False in `known` if nothing is lit.
struct ToneLevel {
  double log2_middle = 0;
  bool known = false;
};
ToneLevel tone_level(const std::vector<Rgba>& layers, const std::vector<double>& matte,
                     unsigned width, unsigned height);
/// The level in force after a measurement.
ToneLevel follow(const ToneLevel& before, const ToneLevel& measured);

/// The edited pixel; `share` = strength · matte.
Rgba tone(const Rgba& layers, double share, const std::vector<TonePoint>& points,
          double log2_middle);

}  // namespace inverse::reference
