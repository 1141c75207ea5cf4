// How much indirect light a scene has: the one factor kappa of the gathered light E0 for which what
// it leaves of the image's chroma is sharpest and most neutral.
#pragma once

#include "global_color.hpp"

namespace inverse::reference::global {

struct AmountParams {
  double manual = 0;         ///< Above 0: this amount, nothing is measured.
  double neutral = 1;     ///< Weight of neutrality beside sharpness; >= 0.
  double neutral_width = 0.2;  ///< Log chroma that still counts as neutral.
  double typical = 0.5;      ///< Where the prior has its least cost.
  double prior = 0.15;       ///< Its weight, for the tint.
  double prior_split = 0.15;  ///< Its weight, for the split into direct and indirect.
  double time = 0.5;         ///< Weight of what changes in time beside sharpness; >= 0.
  double noise = 0.02;       ///< Change of chroma that means nothing.
  double renew = 0.2;        ///< Share of a frame in the cost that is carried on, 0 ... 1.
};

inline constexpr int kCandidates = 16;
inline constexpr double kLeastAmount = 0.06, kAmountRatio = 1.24;  ///< Up to 1.5.

/// What the points of the grid were in the frame before, for what changes in time.
struct LightBefore {
  std::vector<Chroma> chroma;
  std::vector<double> shading, weight;
  std::vector<Vec3> received;
};

/// Squared change of chroma that is left when the change of tint by every candidate is taken away,
/// and (last) when nothing is: weighted means, carried on from frame to frame.
using ChangeLeft = std::array<double, kCandidates + 1>;

/// Of one frame after another; changes beyond 0.15 count as that (something else is in view).
ChangeLeft change_left(const Grid& grid, const std::vector<Vec3>& received,
                       const LightBefore& before);

struct Amount {
  double tint = 0;   ///< kappa.
  double split = 0;  ///< The same where only brightness counts: nearer to the typical one.
};

/// Cost of every candidate for light E0 at the points of the grid (before the prior).
std::array<double, kCandidates> amount_cost(const Grid& grid, const std::vector<Vec3>& received,
                                            const AmountParams& params);

/// The amounts of least cost.
Amount amount_of(const std::array<double, kCandidates>& cost, const ChangeLeft& change,
                 const AmountParams& params);

}  // namespace inverse::reference::global
