// The plain specification of globalintrinsic: I = R (T0 1 + E), white direct light T0, colored
// indirect light E. What light E is, up to one amount for the scene, the image itself tells (its
// surfaces are the emitters: global_gather.hpp); the amount is the one that leaves the sharpest
// chroma (global_amount.hpp); base colors are the modes of that chroma (global_palette.hpp); what
// varies slowly around them is light, too (global_tint.hpp). The tint of the light is divided out,
// and intrinsicdecomp's energy decides how bright reflectance and light are. See
// docs/method-globalintrinsic.md. Double precision, no dependencies.
#pragma once

#include "global_amount.hpp"
#include "global_tint.hpp"
#include "intrinsic_decomposition.hpp"
#include "output_gauge.hpp"

namespace inverse::reference {

struct GlobalParams {
  IntrinsicParams solve;
  GaugeParams gauge;
  int warm_cycles = 2;  ///< Multigrid cycles of a frame that continues the one before.
  int grid = 80;        ///< Points along the longer side of the grid, at most.
  global::GatherParams gather;
  global::AmountParams amount;
  global::PaletteParams palette;
  global::TintParams tint;
  bool merge = true;    ///< Whether shaded base colors are given to lit ones.
};

/// Carried from frame to frame.
struct GlobalState {
  IntrinsicState solve;  ///< Of the frame without its tint.
  OutputGauge gauge{GaugeParams{}};
  double log_scale = 0;  ///< ln of the factor from the solver's R to the layer's.
  std::vector<double> histogram;
  global::AmountCost cost{};
  global::BaseColors colors;
  std::vector<global::Chroma> tint;  ///< At the points of the grid.
  double full = 0;                   ///< TintStatistics::full.
  bool known = false;
};

struct GlobalResult {
  std::vector<double> reflectance, indirect;  ///< 3 interleaved channels; I = R (direct + indirect).
  std::vector<double> direct;
  std::vector<int> label;     ///< Base color of every pixel (slot).
  global::BaseColors colors;
  global::Amount amount;
  global::AmountCost cost{};  ///< Carried on from frame to frame.
  double tint = 0;            ///< Rms tint where all light is indirect, log chroma.
  IntrinsicStats stats;
};

/// Decomposes one frame of interleaved linear RGB. `state` may be null (a still).
GlobalResult decompose_global(const double* rgb, int width, int height, const GlobalParams& params,
                              GlobalState* state);

}  // namespace inverse::reference
