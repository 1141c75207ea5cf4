// How much indirect light a scene has: the one factor kappa of the gathered light E0 for which what
// it leaves of the image's chroma is sharp and neutral.
#pragma once

#include "global_color.hpp"

namespace inverse::reference::global {

struct AmountParams {
  double manual = 0;           ///< Above 0: this amount, whatever the image says.
  double neutral = 1.5;        ///< Weight of neutrality beside sharpness; >= 0.
  double neutral_width = 0.2;  ///< Log chroma that still counts as neutral.
  double typical = 0.5;        ///< Amount of a scene that says nothing.
  double spread = 0.65;        ///< Standard deviation of ln amount among scenes.
  double trust = 8;            ///< Log-likelihood of a difference of cost of 1,
  double full_trust = 0.35;    ///< from this spread of chroma on; below, in proportion to it.
  double no_color = 0.03;      ///< Spread of chroma where there is no color to go by,
  double full_color = 0.06;    ///< and from where on there is; in between the amount fades.
};

inline constexpr int kCandidates = 16;
inline constexpr double kLeastAmount = 0.06, kAmountRatio = 1.24;  ///< Up to 1.5.
using AmountCost = std::array<double, kCandidates>;

/// The i-th candidate, kLeastAmount kAmountRatio^i.
double candidate(int i);

struct Amount {
  double value = 0;       ///< kappa.
  double confidence = 0;  ///< 0: the image says nothing, the typical one; 1: it leaves no doubt.
  double color = 0;       ///< How far the color of the gathered light is believed, 0 ... 1.
};

/// Cost of every candidate for light E0 at the points of the grid: entropy of the histogram of
/// z - t, less the share of it that is neutral.
AmountCost amount_cost(const Grid& grid, const std::vector<Vec3>& received,
                       const AmountParams& params);

/// How far chroma spreads over the grid: its standard deviation.
double color_spread(const Grid& grid);

/// What color there is to go by, 0 ... 1: all of it where `manual` asks for no measurement.
double usable_color(double spread, const AmountParams& params);

/// Mean of ln kappa under the log-likelihood -trust cost and a normal prior, and by how much its
/// variance is below the prior's. Colors that lie close together are moved alike by any tint, past
/// the borders of bins and towards gray, which says nothing of whether it is right: the less chroma
/// spreads, the less a difference of cost is trusted; but not where it is about the color of the
/// light, for which there is nothing better. All fade with usable_color.
Amount amount_of(const AmountCost& cost, double spread, const AmountParams& params);

}  // namespace inverse::reference::global
