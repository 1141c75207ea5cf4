// SPDX-License-Identifier: LGPL-2.1-or-later
// The specification of globalintrinsic: I = R (T0 1 + E), white direct light T0, colored indirect
// light E. E is estimated from the image up to one amount for the scene (global_gather.hpp). The
// amount makes chroma sharpest (global_amount.hpp); base colors are the modes of that chroma
// (global_palette.hpp); slow variations around them belong to the light (global_tint.hpp). The tint
// of the light is divided out, and intrinsicdecomp's energy separates the brightness of reflectance
// and light. See docs/reference/methods/globalintrinsic.md. Double precision, no dependencies.
#pragma once

#include "global_amount.hpp"
#include "global_tint.hpp"
#include "tests/reference/intrinsic/intrinsic_decomposition.hpp"
#include "tests/reference/intrinsic/output_scale.hpp"

namespace inverse::reference {

struct GlobalParams {
  IntrinsicParams solve;
  ScaleParams scale;
  int warm_cycles = 2;       ///< Multigrid cycles of a frame that continues the one before.
  int grid = 40;             ///< Points along the longer side of the grid, at most.
  double update_rate = 0.2;  ///< Weight of a frame in quantities averaged over time, 0 ... 1.
  double cut_chroma = 0.3;   ///< Mean change of chroma, in halves, from which on a frame is a cut.
  double white_balance = 0;  ///< Share of the illuminant's estimated log chroma that is removed.
  global::GatherParams gather;
  global::AmountParams amount;
  global::PaletteParams palette;
  global::TintParams tint;
};

/// State of the grid between frames.
struct GlobalScene {
  std::vector<double> histogram;  ///< Of chroma without tint, normalized.
  global::AmountCost cost{};
  global::BaseColors colors;
  std::vector<global::Chroma> chroma;  ///< Of the frame, at the points of the grid.
  std::vector<int> labels;             ///< Base colors of these points; empty: unknown.
  global::Chroma white{};              ///< Log chroma of the removed illuminant.
  double color = 0;                    ///< Confidence in the color of light.
  int frames = 0;                      ///< Analyzed since a reset or cut.
};

/// State between frames.
struct GlobalState {
  IntrinsicState solve;  ///< Of the frame without its tint.
  OutputScale scale{ScaleParams{}};
  double log_scale = 0;  ///< ln of the factor from the solver's R to the layer's.
  GlobalScene scene;
};

struct GlobalResult {
  std::vector<double> reflectance, indirect;  ///< 3 interleaved channels.
  /// White. I = R (direct + indirect) times the illuminant's color and that of light at its shading
  /// (light_color.hpp).
  std::vector<double> direct;
  std::vector<int> label;     ///< Base color of every pixel (slot).
  global::BaseColors colors;  ///< Of the frame and those before.
  global::Gather gather;      ///< What every base color sends where.
  int gather_factor = 1;      ///< Pixels along the side of one of the gather's points.
  global::Amount amount;
  global::Chroma white{};  ///< Log chroma of the removed illuminant.
  double tint = 0;         ///< Rms tint where all light is indirect, log chroma.
  bool cut = false;        ///< The history was discarded.
  IntrinsicStats stats;
};

/// Decomposes one frame of interleaved linear RGB. `state` may be null (a still).
GlobalResult decompose_global(const double* rgb, int width, int height, const GlobalParams& params,
                              GlobalState* state);

}  // namespace inverse::reference
