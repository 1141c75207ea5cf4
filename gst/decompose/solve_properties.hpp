// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "interaction.hpp"
#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "method.hpp"
#include "prior_models.hpp"

namespace inverse {

/// The parameters of an element whose method solves by ScaledIntrinsic: the method's, and these.
template <typename MethodParams>
struct SolveParams : MethodParams, DecomposerParams, InteractionParams {
  float skip_error = Tolerances::kSkipError;  ///< rms log shading
  std::string prior_source = PriorModels::kFitted;
  void take_defaults(const SolveParams& set) {
    skip_error = set.skip_error;
    this->tolerances.scale_to(skip_error);
  }
  void derive() { this->adaptive = this->adaptive && skip_error > 0; }
};

/// The properties of SolveParams<…>, P.
template <typename P>
PropertyTable<P> solve_properties() {
  const auto tolerance = [](float Tolerances::*member) {
    return [member](P& p) -> float& { return p.tolerances.*member; };
  };
  return {
      flag<P>("adaptive", &P::adaptive, "Skip work within skip-error; turn off to compare"),
      number<P>(
          "skip-error", &P::skip_error, 0.f, 1.f,
          "Target for the estimated error of skipped work (rms log shading); 0 = skip nothing"),
      tuning(number<P>("cycle-tolerance", tolerance(&Tolerances::cycle), 0.f, 1.f,
                       "Change by a multigrid cycle after which no other follows (rms log "
                       "shading); 0 = all run")),
      tuning(flag<P>("half-resolution", &P::half_resolution,
                     "Solve at half width and height, for speed")),
      tuning(flag<P>("quarter-resolution", &P::quarter_resolution,
                     "With half-resolution: solve at a quarter of width and height")),
      tuning(number<P>(
          "half-tolerance", tolerance(&Tolerances::half), 0.f, 1.f,
          "Maximum error at which half resolution is chosen (rms log shading); 0 = never")),
      tuning(number<P>(
          "chroma-tolerance", tolerance(&Tolerances::chroma), 0.f, 1.f,
          "Maximum effect of the equal-chroma term that is skipped (rms log shading); 0 = never")),
      tuning(number<P>(
          "gate-tolerance", tolerance(&Tolerances::gate), 0.f, 1.f,
          "Temporal gate (rms over cells) below which pixels are not compared; 0 = never skip")),
      tuning(number<P>("repeat-tolerance", tolerance(&Tolerances::repeat), 0.f, 0.1f,
                       "Change by the last cycle below which a repeated picture reuses its layers "
                       "(rms log shading)")),
      tuning(number<P>(
          "edge-tolerance", tolerance(&Tolerances::edge), 0.f, 1.f,
          "Change of a tile at which its edges are evaluated again (log intensity or chroma)")),
      tuning(
          number<P>("cycles", &P::cycles, 1u, 32u, "Multigrid cycles of a frame without history")),
      tuning(number<P>("warm-cycles", &P::warm_cycles, 1u, 32u,
                       "Multigrid cycles of a frame that starts from the one before")),
      number_or_auto<P>(
          "light-color-slope", [](P& p) -> std::optional<float>& { return p.light.slope; },
          -SceneLight::kMaxSlope, SceneLight::kMaxSlope,
          "Step of ln red/blue of light with a step of its ln brightness, -2 to 2; auto = found in "
          "the frames, 0 = gray light"),
      text<P>("prior", &P::prior_source,
              "What tells paint from light: fitted = a function of a few pixels, learned = also a "
              "network that comes with gst-inverse, else the path of one (.net), which may also "
              "estimate reflectance"),
      number<P>(
          "reflectance-weight", [](P& p) -> float& { return p.prior.reflectance_weight; }, 1e-3f,
          1e3f, "Weight of smooth reflectance; raise it to move texture into shading"),
      number<P>(
          "shading-weight", [](P& p) -> float& { return p.prior.shading_weight; }, 1e-3f, 1e3f,
          "Weight of smooth shading; raise it to move shadows into reflectance"),
      tuning(number<P>(
          "value-weight", [](P& p) -> float& { return p.prior.value_weight; }, 1e-3f, 1e3f,
          "Weight of the prior that the largest channel of reflectance is near 1")),
      tuning(number<P>(
          "chroma-weight", [](P& p) -> float& { return p.prior.chroma_weight; }, 0.f, 1e3f,
          "Weight of equal reflectance for equal chroma; 0 = term skipped")),
      tuning(number<P>(
          "depth-weight", [](P& p) -> float& { return p.prior.depth_weight; }, 0.f, 4.f,
          "Weight of the remembered scene's surfaces in telling paint from shading: shading is "
          "even "
          "on flat ones and turns with their normal; 0 = off")),
      number<P>(
          "temporal-weight", [](P& p) -> float& { return p.anchor.anchor_weight; }, 0.f, 1e3f,
          "Weight of steady reflectance where nothing moves; raise it against flicker, 0 = off"),
      tuning(number<P>(
          "temporal-frames", [](P& p) -> float& { return p.anchor.anchor_frames; }, 1.f, 1e3f,
          "Frames after a cut or a gap until the temporal weight is full")),
      tuning(number<P>(
          "temporal-chroma", [](P& p) -> float& { return p.anchor.anchor_chroma; }, 1e-3f, 10.f,
          "Change of chroma that halves the temporal weight, natural log units")),
      tuning(number<P>(
          "temporal-detail", [](P& p) -> float& { return p.anchor.anchor_detail; }, 1e-3f, 10.f,
          "Change of local contrast that halves the temporal weight, natural log units")),
      tuning(number<P>(
          "temporal-texture", [](P& p) -> float& { return p.anchor.anchor_texture; }, 1e-3f, 10.f,
          "Spread of change within a cell that halves the temporal weight, natural log units")),
      tuning(number<P>(
          "temporal-motion", [](P& p) -> float& { return p.anchor.anchor_motion; }, 1e-2f, 100.f,
          "Moved share of the local texture that halves the temporal weight")),
      number<P>(
          "temporal-hold", [](P& p) -> float& { return p.anchor.hold; }, 0.f, 0.99f,
          "Share of the last frame's reflectance kept where nothing changes; raise it against "
          "sensor noise"),
      tuning(number<P>(
          "temporal-hold-light", [](P& p) -> float& { return p.anchor.hold_light; }, 1e-3f, 10.f,
          "Change of a cell's intensity that halves temporal-hold, natural log units")),
      tuning(number<P>(
          "temporal-hold-texture", [](P& p) -> float& { return p.anchor.hold_texture; }, 1e-3f,
          10.f,
          "Change of a pixel relative to its cell that halves temporal-hold, natural log units")),
      number<P>(
          "white-level", [](P& p) -> float& { return p.scale.white_level; }, 0.05f, 1.f,
          "Reflectance of the brightest surfaces when a scene begins; raise it for brighter "
          "reflectance, 1 = display white"),
      tuning(number<P>(
          "white-quantile", [](P& p) -> float& { return p.scale.white_quantile; }, 0.f, 1.f,
          "Share of the frame that is darker than the surfaces that white-level scales")),
      tuning(number<P>(
          "cut-fraction", [](P& p) -> float& { return p.anchor.cut_fraction; }, 0.f, 1.f,
          "Mean mismatch with the previous frame at which a scene cut is detected")),
  };
}

/// The blurb of `quality`.
inline constexpr const char* kSolveSets =
    "Work for each frame: lower is faster, higher is more accurate; explicit settings win";

/// What of a completed frame's solve was skipped, and what was run although it might be.
DecompositionMethod::Work solve_work(const ScaledIntrinsic::Stats& solve,
                                     const ScaledIntrinsic::Findings& found);

/// Adds fields about the solve of a completed frame.
void describe_solve(GstStructure* stats, const ScaledIntrinsic::Stats& solve,
                    const ScaledIntrinsic::Findings& found);

/// Whether a frame's time predicts that of others: all of it was solved, and once.
bool typical(const ScaledIntrinsic::Stats& solve);

}  // namespace inverse
