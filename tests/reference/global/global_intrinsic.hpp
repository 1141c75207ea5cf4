// The plain specification of globalintrinsic: I = R (T0 1 + E), white direct light T0, colored
// indirect light E. What light E is, up to one amount for the scene, the image itself tells (its
// surfaces are the emitters: global_gather.hpp); the amount is the one that leaves the sharpest
// chroma (global_amount.hpp); base colors are the modes of that chroma (global_palette.hpp); what
// varies slowly around them is light, too (global_tint.hpp). The tint of the light is divided out,
// and intrinsicdecomp's energy decides how bright reflectance and light are. See
// docs/reference/methods/globalintrinsic.md. Double precision, no dependencies.
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
  double renew = 0.2;        ///< Share of a frame in what is carried from frame to frame, 0 ... 1.
  double cut = 0.3;          ///< Mean change of chroma, in halves, from which on a frame is a cut.
  double white_balance = 0;  ///< Share of the illuminant's estimated log chroma that is taken out.
  global::GatherParams gather;
  global::AmountParams amount;
  global::PaletteParams palette;
  global::TintParams tint;
};

/// What the small grid knows from frame to frame.
struct GlobalScene {
  std::vector<double> histogram;  ///< Of chroma without tint, normalized.
  global::AmountCost cost{};
  global::BaseColors colors;
  std::vector<global::Chroma> chroma;  ///< Of the frame, at the points of the grid.
  std::vector<int> labels;             ///< Base colors of these points; empty: not known.
  global::Chroma white{};              ///< Log chroma of the illuminant that was taken out.
  double color = 0;                    ///< How far the color of light is believed.
  int frames = 0;                      ///< Looked at since a reset or cut.
};

/// Carried from frame to frame.
struct GlobalState {
  IntrinsicState solve;  ///< Of the frame without its tint.
  OutputScale scale{ScaleParams{}};
  double log_scale = 0;  ///< ln of the factor from the solver's R to the layer's.
  GlobalScene scene;
};

struct GlobalResult {
  std::vector<double> reflectance, indirect;  ///< 3 interleaved channels.
  std::vector<double> direct;  ///< White. I = R (direct + indirect) times the illuminant's color.
  std::vector<int> label;      ///< Base color of every pixel (slot).
  global::BaseColors colors;   ///< Of the frame and those before.
  global::Gather gather;       ///< What every base color sends where.
  int gather_factor = 1;       ///< Pixels along the side of one of the gather's points.
  global::Amount amount;
  global::Chroma white{};  ///< Log chroma of the illuminant that was taken out.
  double tint = 0;         ///< Rms tint where all light is indirect, log chroma.
  bool cut = false;        ///< Nothing was taken over from the frame before.
  IntrinsicStats stats;
};

/// Decomposes one frame of interleaved linear RGB. `state` may be null (a still).
GlobalResult decompose_global(const double* rgb, int width, int height, const GlobalParams& params,
                              GlobalState* state);

}  // namespace inverse::reference
