// SPDX-License-Identifier: LGPL-2.1-or-later
// The specification of intrinsicdecomp: one unknown per pixel, log shading s; r = i - s.
//
//   E(s) = sum over edges  a (ds - dm)^2 + b ds^2        reflectance constant | shading constant
//        + sum over cells  v (S - V)^2                    value prior: pins scale, low frequencies
//                        + g (M - S - rho_bin(c))^2       equal chroma, equal reflectance (soft)
//        + sum over pixels t (s - s_before)^2             temporal anchor
//
// over 4 x 4 cells with means S of s and M of m; m is the mean log intensity, d the difference
// across an edge. a, b, v, V and g come from EdgePrior, a small fitted function of local cues. See
// docs/reference/methods/intrinsicdecomp.md. Double precision, no dependencies.
#pragma once

#include <cstddef>
#include <vector>

#include "intrinsic_features.hpp"
#include "prior_network.hpp"
#include "strokes.hpp"

namespace inverse::reference {

/// Names and defaults are those of kernels/intrinsic.
struct IntrinsicParams {
  double reflectance_weight = 1;  ///< Scales a; > 0.
  double shading_weight = 1;      ///< Scales b; > 0.
  double value_weight = 1;        ///< Scales v; > 0 (0 leaves the scale free).
  double chroma_weight = 1;       ///< Scales g; >= 0; 0 switches the chroma bins off.
  double anchor_weight = 1.2;     ///< t where nothing moves; >= 0; 0 switches the anchor off.
  double anchor_frames = 7;       ///< Frames after a reset or cut until t is that.
  double anchor_chroma = 0.5;  ///< Log-chroma change that halves the anchor, where there is light.
  double anchor_detail = 4;    ///< Change of local log contrast that halves the anchor.
  double anchor_texture = 2;   ///< Deviation of change inside a cell that halves it.
  double anchor_motion = 0.4;  ///< Share of structure around that halves it when it moves.
  double hold = 0.8;           ///< Share of the last reflectance that stays where all is still.
  double hold_light = 0.02;    ///< Change of a cell's log intensity that halves that.
  double hold_texture = 0.2;   ///< A pixel's change beyond its cell's that halves that.
  double cut_fraction = 0.3;   ///< Mean mismatch in [0, 1] from which on the frame is a cut; a
                               ///< sixth of it if that is eight times the mismatch before.
  LightColor light;            ///< In force for the frame.
  const StrokeMask* strokes = nullptr;      ///< Of the user; null: none.
  const network::Graph* network = nullptr;  ///< Adds to the fitted prior; null: none.
  int cycles = 4;                           ///< Multigrid cycles.
  double slowest = 0.5;  ///< Error factor up to which cycles are extrapolated; 0: not.
  int cell_cycles = 2;   ///< Cycles from the cell level down within each; bins renewed before each.
};

inline constexpr int kBins = 48;              ///< Cells of the chroma grid along each axis.
inline constexpr double kBinWidth = 0.1;      ///< Natural log units.
inline constexpr double kCoarseScale = 0.6;   ///< Of summed edge weights, per level.
inline constexpr double kCellArea = 16;       ///< Weights of cell terms are per pixel, times this.
inline constexpr double kMinDiagonal = 1e-6;  ///< Keeps a 1 x 1 frame regular.
inline constexpr double kLogLow = -4.5;       ///< Least ln of a, b, v, g before the user's factors.
inline constexpr double kLogHigh = 3;         ///< Largest.

/// Weights of the prior: of each pixel's right and lower edge (width x height), and of each cell of
/// guide level kCellLevel.
struct EdgePrior {
  std::vector<double> a_right, b_right, a_down, b_down;
  std::vector<double> v, V, g;
};

/// Evaluates the fitted prior and what `network` adds, or null.
EdgePrior edge_prior(const Guide& guide, const IntrinsicParams& params,
                     const PriorNetwork* network);
/// The same with params.network.
EdgePrior edge_prior(const Guide& guide, const IntrinsicParams& params);

/// State between frames.
struct IntrinsicState {
  int width = 0, height = 0;
  /// Of the previous frame; empty after a reset. Of cells; the multigrid's source term and mean
  /// shading at its end; of pixels m, s and the brightness of reflectance.
  std::vector<double> detail, c0, c1, mean, source, coarse, m, s, rho;
  int frames = 0;       ///< Anchored since the last reset or cut.
  double expected = 0;  ///< Largest mismatch of these, which fades by .9 a frame.
};

struct IntrinsicStats {
  std::vector<double> change;  ///< Root mean square change of s by each cycle, log units.
  double mismatch = 0;         ///< Mean temporal mismatch, 0 (static) ... 1.
  bool anchored = false;
};

struct IntrinsicResult {
  std::vector<double> log_shading;  ///< s, width x height.
  /// 3 interleaved channels: sanitized I * exp(-s), divided by the color of light at s.
  std::vector<double> reflectance;
  IntrinsicStats stats;
};

/// Decomposes one frame. `state` may be null (a still); otherwise it is read and updated.
IntrinsicResult decompose(const double* rgb, int width, int height, const IntrinsicParams& params,
                          IntrinsicState* state);

// The parts, for tests of single kernels.

/// Chroma-bin means of rho over cells, and the total weight of each bin: kBins^2 values each.
struct ChromaBins {
  std::vector<double> mean, weight;
};
ChromaBins splat_bins(const GuideLevel& cells, const std::vector<double>& g,
                      const std::vector<double>& rho);

/// Value of the bins at a chroma.
double slice_bins(const ChromaBins& bins, double c0, double c1);

}  // namespace inverse::reference
