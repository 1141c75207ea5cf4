// SPDX-License-Identifier: LGPL-2.1-or-later
// Stabilization of reflectance by what is known of it (thesis, Eq. 4.8), on cells.
#pragma once
#include <vector>

#include "intrinsic_decomposition.hpp"

namespace inverse::reference {

/// What is known of a frame's surfaces, in a size of its own; it shows what the frame shows.
struct KnownReflectance {
  int width, height;
  std::vector<double> log_reflectance;  ///< 3 a pixel
  std::vector<double> confidence;       ///< 0 … 1
  std::vector<double> known_depth;      ///< meters; 0: nothing is known
  std::vector<double> depth;            ///< of the frame; 0: unknown
  double weight;                        ///< of a pixel
};

/// Adds to v (s' - V)^2 of each cell  t (s' - (m' - r' + ln c))^2.  With k over 4 x 4 points of the
/// cell, w_k their confidence, 0 where the depths differ by more than 2 cm and four standard
/// deviations of a structured-light sensor: r' = sum w_k mean_c ln R_k / sum w_k,
/// t = weight sum w_k / (1 + (d / .4)^2), d the distance of the cell's chroma from that of the
/// known color at the cell's brightness.
void recall(const Guide& guide, const KnownReflectance& known, double log_scale, EdgePrior& prior);

}  // namespace inverse::reference
