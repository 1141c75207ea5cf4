// SPDX-License-Identifier: LGPL-2.1-or-later
// The user's strokes in intrinsicdecomp (thesis, 4.5 and Eq. 4.7): pixels of a stroke share one
// shading, or one reflectance. Double precision.
#pragma once

#include <vector>

#include "intrinsic_features.hpp"

namespace inverse::reference {

struct EdgePrior;

enum class StrokeKind { shading, reflectance };

/// Which stroke a pixel belongs to, and how firmly.
struct StrokeMask {
  std::vector<StrokeKind> kinds;  ///< of the strokes
  std::vector<int> stroke;        ///< of each pixel, its index in `kinds`; -1: none
  std::vector<double> weight;     ///< 0 to 1
};

/// Extends strokes to their surroundings (thesis, 4.5.2, in the picture): a pixel of no stroke is
/// added to the filled stroke whose mean reflectance is nearest, if it is nearer than
/// kFillDistance (Euclidean, linear RGB) and connected to it by such pixels, over edges. Its weight
/// is min(1, 2 (1 - distance/kFillDistance))^2. `rgb` is interleaved.
inline constexpr double kFillDistance = 0.1;
void fill_strokes(const std::vector<bool>& filled, const double* rgb, int width, StrokeMask& mask);

/// Edges inside a stroke get this much more weight.
inline constexpr double kStrokeWeight = 1000;

/// Changes the prior so that the solution has one shading, or one reflectance, inside each stroke.
///
/// Eq. 4.7 pulls every pixel of a stroke toward an unknown value, all with one large weight. The
/// same minimum, in the limit, comes from large weights between neighbors, which multigrid reduces
/// as it does other edges. An edge whose pixels belong to one stroke, w the smaller of their
/// weights:
///
///   (1 - w) (a (ds - dm)^2 + b ds^2) + w (a + b + W) (ds - d)^2,   d = 0 or dm
///
/// Cell terms would pull the stroke's parts toward different values. A cell of which the share c
/// lies in a stroke (a pixel counts w) has the chroma weight (1 - c) g, and the target
///
///   (1 - c) V + c (mean V of the stroke)                 shading
///   (1 - c) V + c (M + mean (V - M) of the stroke)       reflectance
///
/// with means weighted by c v: with one value in the stroke, v (s - V)^2 has the same minimum.
void apply_strokes(const Guide& guide, const StrokeMask& mask, EdgePrior& prior);

}  // namespace inverse::reference
