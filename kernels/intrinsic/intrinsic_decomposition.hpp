// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "kernels/image/layers.hpp"
#include "kernels/intrinsic/chroma/chroma_bins.hpp"
#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic/light_color/scene_light.hpp"
#include "kernels/intrinsic/multigrid/multigrid.hpp"
#include "kernels/intrinsic/output/output_scale.hpp"
#include "kernels/intrinsic/prior/edge_prior.hpp"
#include "kernels/intrinsic/recall/recall.hpp"
#include "kernels/intrinsic/strokes/strokes.hpp"
#include "kernels/intrinsic/temporal/temporal_anchor.hpp"
#include "kernels/intrinsic_energy_assemble.spv.hpp"
#include "kernels/intrinsic_energy_cell_terms.spv.hpp"
#include "kernels/intrinsic_energy_warm_start.spv.hpp"
#include "kernels/intrinsic_output_layers.spv.hpp"
#include "kernels/reuse/plan.hpp"
#include "kernels/solve_total.spv.hpp"

namespace inverse {

/// Live intrinsic decomposition: reflectance and scalar shading of every frame of a video
/// (energy.glsl; docs/reference/methods/intrinsicdecomp.md). Owns the kernels and the temporal
/// state for one size on one device. Not thread-safe.
class IntrinsicDecomposition {
 public:
  struct Params {
    SceneLight::Params light;
    EdgePrior::Params prior;
    TemporalAnchor::Params anchor;
    /// Multigrid cycles of a frame without history, 1…32.
    uint32_t cycles = 4;
    /// The same of a frame that continues the one before, and so starts near its solution, 1…32.
    uint32_t warm_cycles = 2;
    Multigrid::Params multigrid;
    OutputScale::Params scale;
    /// Skips what a frame does not need (kernels/reuse/plan.hpp;
    /// docs/reference/methods/intrinsicdecomp.md, 10).
    bool adaptive = true;
    Tolerances tolerances;
    bool operator==(const Params&) const = default;
  };
  struct FrameInfo {
    bool reset = false;           ///< no relation to the frame before (discontinuity)
    bool repeated = false;        ///< the picture is that of the frame before, bit by bit
    SceneLight* light = nullptr;  ///< what it measured of this frame; null: light is gray
    StrokesPtr strokes = {};      ///< of the user; other ones than before start the solve anew
    /// What follows these strokes, and has found them in this frame; null: they stay as drawn.
    const StrokeTracker* tracker = nullptr;
    const SeenStrokes* seen = nullptr;        ///< those in the scene; null: they are not seen
    const KnownReflectance* known = nullptr;  ///< null: nothing
  };
  struct Stats {
    Plan plan;
    uint32_t levels = 0;  ///< of the multigrid
    uint32_t tiles = 0;   ///< of 16 x 16 pixels, of a frame
    Tolerances tolerances;
    PriorModelPtr network;      ///< of the prior; null: the fitted one alone
    uint32_t network_age = 0;   ///< frames since it ran; 0: it ran for this one, or nothing changed
    uint32_t network_runs = 0;  ///< on the host; 0 elsewhere
  };

  /// Throws Error(limit) if frames of this size do not fit the device.
  IntrinsicDecomposition(std::shared_ptr<gpu::Device> device, Extent extent);

  /// Records the decomposition of `input` (linear RGB, 1 = full scale; w = alpha) and returns its
  /// layers: input, intrinsic (R.rgb, S), the same plane as model, and in colored light slope. Copy
  /// a plane before editing it in place if others hold it. The frame kFramesInFlight before this
  /// one must have been waited for.
  Layers record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                const FrameInfo& info);
  /// Forgets the frames so far (flush, discontinuity).
  void reset() {
    has_history_ = false;
    start_layers_.reset();
    before_ = {};
    strokes_.forget();
  }
  /// Makes the next frame continue what `other`, of another size on the same device, has just found
  /// of that frame, its scale and the state of its anchor included. `intrinsic` is the result of
  /// `other` (R.rgb, S), resampled to this size.
  void continue_from(gpu::Commands& commands, const IntrinsicDecomposition& other,
                     PlanePtr intrinsic);
  /// Makes what a network of the prior needs, as the first frame with it does otherwise.
  void prepare(const PriorModelPtr& network) { prior_.prepare(network); }
  /// Whether the next frame extends strokes to surroundings of similar reflectance.
  bool fills() const { return strokes_.mask().unfilled(); }
  /// Frames recorded since construction: the last one's number is one less.
  uint64_t recorded() const { return recorded_; }
  /// Of one of the last kFramesInFlight frames.
  const Stats& stats(uint64_t frame) const { return report(frame).stats; }
  /// What the device found of a frame.
  struct Findings : Planner::Found {
    float mismatch = 0;          ///< with the frame before, 0…1; 0 without one
    float scale = 0;             ///< ln of the factor from the solver's R to the layer's
    float slope = 0;             ///< of the color of light; 0: gray
    float slope_confidence = 1;  ///< 0…1
    SceneLight::Did slope_found = SceneLight::Did::reused;
    /// Of each stroke, rms ln shading or ln reflectance from its mean.
    std::vector<float> strokes;
  };
  /// Of one of the last kFramesInFlight frames, once its Commands have been waited for.
  Findings findings(uint64_t frame) const;
  /// Of the last one.
  Findings findings() const { return findings(recorded_ - 1); }

 private:
  struct Report {
    Stats stats;
    bool colored = false;  // light
    uint32_t strokes = 0;  // how many
    gpu::BufferPtr found;  // Numbers
  };
  const Report& report(uint64_t frame) const { return reports_[frame]; }
  /// What the prior writes, and the strokes that change it.
  EdgePrior::Target prior_target();
  // The parts of `record`, in its order.
  void take_strokes(gpu::Commands& commands, const PlanePtr& input, const FrameInfo& info);
  void make_plan(const Params& params, const FrameInfo& info);
  void start_from_layers(gpu::Commands& commands, const PlanePtr& input);
  void evaluate_edges(gpu::Commands& commands, const Params& params);
  void assemble(gpu::Commands& commands, const TemporalAnchor::Params& params,
                const KnownReflectance* known);
  void solve(gpu::Commands& commands, const Params& params);
  PlanePtr write_layers(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                        const PlanePtr& slope);
  void find_scale(gpu::Commands& commands, const Params& params, const SceneLight* light);
  void record_report(gpu::Commands& commands, const Params& params, const PlanePtr& slope);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  PlanePool planes_;
  Guide guide_;
  Strokes strokes_;
  DepthCue depth_cue_;
  EdgePrior prior_;
  Recall recall_;
  TemporalAnchor anchor_;
  ChromaBins bins_;
  Multigrid multigrid_;
  OutputScale scale_;
  gpu::Program<shaders::intrinsic_energy_cell_terms> terms_kernel_, anchored_terms_kernel_,
      measuring_terms_kernel_;
  gpu::Program<shaders::intrinsic_energy_assemble> assemble_, anchored_assemble_;
  gpu::Program<shaders::intrinsic_output_layers> layers_, anchored_layers_, colored_layers_,
      anchored_colored_layers_;
  gpu::Program<shaders::intrinsic_energy_warm_start> warm_start_;
  gpu::Program<shaders::solve_total> total_;
  gpu::BufferPtr flux_, value_, terms_, start_, gate_sums_, gate_total_;
  gpu::FrameRing<Report> reports_;
  uint64_t recorded_ = 0;
  bool has_history_ = false;    // there is a frame before
  bool continues_ = false;      // which had one before it
  PlanePtr start_layers_;       // to start from, of another resolution
  bool other_strokes_ = false;  // than the frame before
  struct Frame {
    PlanePtr input, intrinsic;
  };
  Frame before_;          // the frame before, if it is needed to fill strokes
  Params params_;         // that the frames so far were found with
  bool cleared_ = false;  // unused slots of sums
  Planner planner_;
  Plan plan_;  // of the frame being recorded
};

}  // namespace inverse
