// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kernels/image/layers.hpp"
#include "kernels/intrinsic/chroma/chroma_bins.hpp"
#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic/multigrid/multigrid.hpp"
#include "kernels/intrinsic/output/output_scale.hpp"
#include "kernels/intrinsic/prior/edge_prior.hpp"
#include "kernels/intrinsic/reuse/active_tiles.hpp"
#include "kernels/intrinsic/reuse/plan.hpp"
#include "kernels/intrinsic/temporal/temporal_anchor.hpp"
#include "kernels/intrinsic_energy_assemble.spv.hpp"
#include "kernels/intrinsic_energy_cell_terms.spv.hpp"
#include "kernels/intrinsic_energy_warm_start.spv.hpp"
#include "kernels/intrinsic_output_layers.spv.hpp"
#include "kernels/solve_total.spv.hpp"

namespace inverse {

/// Live intrinsic decomposition: reflectance and scalar shading of every frame of a video
/// (energy.glsl; docs/reference/methods/intrinsicdecomp.md). Owns the kernels and the temporal
/// state for one size on one device. Not thread-safe.
class IntrinsicDecomposition {
 public:
  struct Params {
    EdgePrior::Params prior;
    TemporalAnchor::Params anchor;
    /// Multigrid cycles of a frame without history, 1…32.
    uint32_t cycles = 4;
    /// The same of a frame that continues the one before, and so starts near its solution, 1…32.
    uint32_t warm_cycles = 2;
    Multigrid::Params multigrid;
    OutputScale::Params scale;
    /// Leaves out what a frame does not need: edges of tiles that have not changed keep their
    /// weights, cycles end when little changes, and tiles that need no work are left out.
    bool adaptive = true;
    /// Rms change of log shading by a cycle below which no further one follows, 0…1; 0: all run.
    float settled = 0.01F;
    /// Change of a 2 x 2 mean's log intensity or chroma, 0…1, from which on a tile has changed.
    float still_tolerance = 0.05F;
    /// Log shading (rms of cell means, weighted by the value prior) that the chroma bins can move,
    /// 0…1, below which they are left out; 0: never.
    float chroma_tolerance = 0.02F;
    /// Gate of the temporal anchor, rms over cells, 0…1, below which pixels are not compared with
    /// the frame before; 0: never.
    float hold_tolerance = 0.06F;
    /// What a tile may lack, by estimate, of what frames that leave it out would have changed of
    /// its log shading, rms, 0…1, before one works on it again, for all of them at once; only where
    /// its input stays the same (FrameInfo::changed). 0: no tile is left out.
    float tile_tolerance = 0.02F;
    bool operator==(const Params&) const = default;
  };
  struct FrameInfo {
    bool reset = false;  ///< no relation to the frame before (discontinuity)
    /// Of every tile of 16 x 16 pixels, row by row, 0 where the input is, bit by bit, that of the
    /// frame before. Empty: not known.
    std::span<const uint8_t> changed;
  };
  struct Stats {
    uint32_t cycles = 0;               ///< multigrid cycles at most
    bool stops = false;                ///< fewer where little changes
    uint32_t levels = 0;               ///< of the multigrid
    bool history = false;              ///< a frame before was looked at
    bool bins = true;                  ///< the chroma bins are part of the energy
    bool holds = false;                ///< pixels are compared with the frame before
    std::vector<std::string> skipped;  ///< what was left out, and why
    uint32_t tiles = 0;                ///< tiles of 16 x 16 pixels that a frame has
    bool listed = false;               ///< only tiles that need work were worked on
  };

  /// Throws Error(limit) where frames of this size do not fit the device.
  IntrinsicDecomposition(std::shared_ptr<gpu::Device> device, Extent extent);

  /// Records the decomposition of `input` (linear RGB, 1 = full scale; w = alpha) and returns its
  /// layers: input, intrinsic (R.rgb, S) and, the same plane, model. Who edits in place copies
  /// first what others hold. The frame kFramesInFlight before this one must have been waited for.
  Layers record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                const FrameInfo& info);
  /// The only tiles where a drawing of the last frame's layers, or of its input, may differ from
  /// one of the frame before; null: all.
  const TileList* drawn() const { return listed() ? &active_.drawn() : nullptr; }
  /// Forgets the frames so far (flush, discontinuity).
  void reset() {
    history_ = false;
    taken_.reset();
    last_.reset();
  }
  /// Goes on, with the next frame recorded, where `other`, on the same device and of another size,
  /// has come to: it has just decomposed that frame, and `intrinsic` is what it found (R.rgb, S) in
  /// this one's size. Instead of its own past the frame then has that, anchor and scale included.
  void take_over(gpu::Commands& commands, const IntrinsicDecomposition& other, PlanePtr intrinsic);
  /// Frames recorded since construction: the last one's number is one less.
  uint64_t recorded() const { return recorded_; }
  /// Of one of the last kFramesInFlight frames.
  const Stats& stats(uint64_t frame) const { return report(frame).stats; }
  /// What the device found out about a frame.
  struct Findings {
    uint32_t cycles = 0;  ///< multigrid cycles that ran, of Stats::cycles
    float change = 0;     ///< rms change of log shading by the last cycle: what is left to do
    float mismatch = 0;   ///< with the frame before, 0…1; 0 without one
    bool cut = false;     ///< a cut: nothing was taken over
    float scale = 0;      ///< ln of the factor from the solver's R to the layer's
    uint32_t tiles_evaluated = 0;  ///< those of Stats::tiles whose edges were decided anew
    uint32_t tiles_active = 0;     ///< those that were worked on
    /// Of a frame that looked, else 0: what the bins can move (Params::chroma_tolerance), and the
    /// anchor's gate (Params::hold_tolerance).
    float binding = 0, gate = 0;
  };
  /// Of one of the last kFramesInFlight frames, once its Commands have been waited for.
  Findings findings(uint64_t frame) const;
  /// Of the last one.
  Findings findings() const { return findings(recorded_ - 1); }

 private:
  /// What is kept of a frame for whoever asks after it is done.
  struct Report {
    Stats stats;
    bool compared_edges = false;  // tiles were compared with those that edges were decided on
    bool measured_bins = false, measured_gate = false;
    gpu::BufferPtr found;  // Numbers
  };
  /// What the last frame that is sure to be done has found, if there is one.
  std::optional<Planner::Found> found_before() const;
  /// The plane for the layers of a frame: where only tiles are worked on, one that has the others.
  PlanePtr layers_plane(gpu::Commands& commands);
  const Report& report(uint64_t frame) const { return reports_[frame]; }
  void record_report(gpu::Commands& commands);
  bool listed() const { return plan_.tiles(); }
  const TileList* list() const { return listed() ? &active_.list() : nullptr; }
  void assemble(gpu::Commands& commands, const TemporalAnchor::Params& params);
  void solve(gpu::Commands& commands, const Params& params);
  void start_from_taken(gpu::Commands& commands, const PlanePtr& input);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  PlanePool planes_;
  Guide guide_;
  EdgePrior prior_;
  TemporalAnchor anchor_;
  ChromaBins bins_;
  Multigrid multigrid_;
  OutputScale scale_;
  ActiveTiles active_;
  TileProgram<shaders::intrinsic_energy_cell_terms> terms_kernel_, anchored_terms_kernel_,
      looking_terms_kernel_;
  TileProgram<shaders::intrinsic_energy_assemble> assemble_, anchored_assemble_;
  TileProgram<shaders::intrinsic_output_layers> layers_, anchored_layers_;
  gpu::Program<shaders::intrinsic_energy_warm_start> warm_start_;
  gpu::Program<shaders::solve_total> total_;
  gpu::BufferPtr flux_, value_, terms_, start_, gate_sums_, gate_total_;
  gpu::FrameRing<Report> reports_;
  uint64_t recorded_ = 0;
  bool history_ = false;
  bool continues_ = false;         // the frame before had one before it
  std::optional<PlanePtr> taken_;  // layers to start from
  Params params_;                  // that the frames so far have been found with
  bool cleared_ = false;           // unused slots of sums
  Planner planner_;
  Plan plan_;      // of the frame being recorded
  PlanePtr last_;  // the layers of the frame before, where the next one might go on from them
  Stats stats_;    // of the frame being recorded
};

}  // namespace inverse
