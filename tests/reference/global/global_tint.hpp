// SPDX-License-Identifier: LGPL-2.1-or-later
// The tint of the light at every pixel: that of the gathered indirect light, plus the slowly
// varying part of the remaining chroma beyond its base color (like a bias field).
#pragma once

#include "global_gather.hpp"
#include "global_palette.hpp"

namespace inverse::reference::global {

struct TintParams {
  double residual_sigma = 0.35;  ///< Residual that counts less, log chroma.
  double tint_sigma = 0.7;       ///< The same, of the tint that all-indirect light has.
  double window = 0.05;          ///< Radius of box filters, of the grid's width.
  double edge = 0.01;   ///< Variance of the residual that counts as an edge (guided filter).
  double gate = 0.01;   ///< Mean square tint of a scene where half of the residual is taken.
  double residual = 1;  ///< Share of the residual that is taken; 0: none.
};

/// Tint statistics of the whole scene.
struct TintStatistics {
  double full = 0;  ///< Rms tint where all light is indirect: rms(t) / rms(fraction).
  double gate = 0;  ///< Share of the residual, st2 / (st2 + gate).
};

/// Residual as a linear function of a pixel's own, at the points of the grid: a e + b; and smoothed
/// e, for unreliable pixels.
struct Residual {
  std::vector<Chroma> slope, offset, smooth;
};

/// Confidence in a pixel's residual.
double label_confidence(const Chroma& residual, double fraction, const TintStatistics& statistics,
                        const TintParams& params);

TintStatistics tint_statistics(const std::vector<Chroma>& tint, const std::vector<double>& fraction,
                               const std::vector<double>& weight, const TintParams& params);

/// Residual at the points of a grid of width x height, of raw residuals and indirect fractions.
Residual residual_field(const std::vector<Chroma>& raw, const std::vector<double>& fraction,
                        int width, int height, const TintStatistics& statistics,
                        const TintParams& params);

}  // namespace inverse::reference::global
