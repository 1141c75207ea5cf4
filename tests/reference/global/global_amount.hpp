// SPDX-License-Identifier: LGPL-2.1-or-later
// The amount of indirect light of a scene: the factor kappa of the gathered light E0 that makes the
// remaining chroma of the image sharp and neutral.
#pragma once

#include "global_color.hpp"

namespace inverse::reference::global {

struct AmountParams {
  double manual = 0;              ///< Above 0: this amount, without measurement.
  double neutral = 1.5;           ///< Weight of neutrality beside sharpness; >= 0.
  double neutral_width = 0.2;     ///< Log chroma that still counts as neutral.
  double typical_amount = 0.5;    ///< Amount of a scene without evidence.
  double spread = 0.65;           ///< Standard deviation of ln amount among scenes.
  double measurement_weight = 8;  ///< Log-likelihood of a difference of cost of 1,
  double full_spread = 0.35;      ///< from this spread of chroma on; below, in proportion to it.
  double no_color = 0.03;         ///< Spread of chroma below which colors are ignored,
  double full_color = 0.06;       ///< and above which they have full weight; linear in between.
};

inline constexpr int kCandidates = 16;
inline constexpr double kMinAmount = 0.06, kAmountRatio = 1.24;  ///< Up to 1.5.
using AmountCost = std::array<double, kCandidates>;

/// The i-th candidate, kMinAmount kAmountRatio^i.
double candidate(int i);

struct Amount {
  double value = 0;       ///< kappa.
  double confidence = 0;  ///< 0: typical amount without evidence; 1: certain.
  double color = 0;       ///< Confidence in the color of the gathered light, 0 ... 1.
};

/// Cost of every candidate for light E0 at the points of the grid: entropy of the histogram of z -
/// t minus its neutral share.
AmountCost amount_cost(const Grid& grid, const std::vector<Vec3>& received,
                       const AmountParams& params);

/// Spread of chroma over the grid: its standard deviation.
double color_spread(const Grid& grid);

/// Weight of the image's colors, 0 ... 1: 1 if `manual` is set.
double usable_color(double spread, const AmountParams& params);

/// Mean of ln kappa under the log-likelihood -measurement_weight cost and a normal prior, and the
/// relative reduction of its variance. Similar colors are moved alike by any tint, across borders
/// of bins and towards gray, which is no evidence for the tint. So the likelihood is weaker for a
/// smaller spread of chroma, except in the estimate of the light's color, which has no alternative.
/// All fade with usable_color.
Amount amount_of(const AmountCost& cost, double spread, const AmountParams& params);

}  // namespace inverse::reference::global
