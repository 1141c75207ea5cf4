#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../image/layers.hpp"
#include "chroma_bins.hpp"
#include "edge_prior.hpp"
#include "guide.hpp"
#include "multigrid.hpp"
#include "output_gauge.hpp"
#include "temporal_anchor.hpp"

namespace inverse {

/// Live intrinsic decomposition: reflectance and scalar shading of every frame of a video
/// (energy.glsl; docs/method-intrinsicdecomp.md). Owns the kernels and the temporal state for one
/// size on one device. Not thread-safe.
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
    OutputGauge::Params gauge;
    /// Leaves out what a frame does not need: edges of tiles that have not changed keep their
    /// weights, and cycles end when little changes.
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
    bool operator==(const Params&) const = default;
  };
  struct FrameInfo {
    bool reset = false;  ///< no relation to the frame before (discontinuity)
  };
  struct Stats {
    uint32_t cycles = 0;               ///< multigrid cycles at most
    bool stops = false;                ///< fewer where little changes
    uint32_t levels = 0;               ///< of the multigrid
    bool history = false;              ///< a frame before was looked at
    bool bins = true;                  ///< the chroma bins are part of the energy
    bool holds = false;                ///< pixels are compared with the frame before
    std::vector<std::string> skipped;  ///< what was left out, and why
    uint32_t tiles = 0;  ///< tiles of 16 x 16 pixels whose edges are decided one by one
  };

  /// Throws Error(limit) where frames of this size do not fit the device.
  IntrinsicDecomposition(std::shared_ptr<gpu::Device> device, Extent extent);

  /// Records the decomposition of `input` (linear RGB, 1 = full scale; w = alpha) and returns its
  /// layers: input, intrinsic (R.rgb, S) and, the same plane, model. Who edits in place copies
  /// first what others hold. The frame kFramesInFlight before this one must have been waited for.
  Layers record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                const FrameInfo& info);
  /// Forgets the frames so far (flush, discontinuity).
  void reset() {
    history_ = false;
    taken_.reset();
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
    float gauge = 0;      ///< ln of the factor from the solver's R to the layer's
    uint32_t tiles_evaluated = 0;  ///< of Stats::tiles; all where `adaptive` is off
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
    bool adaptive = false;
    bool looked_at_bins = false, looked_at_gate = false;
    gpu::BufferPtr found;  // change, verdict, gauge, control, binding, sum of gates squared
  };
  /// Decides, by the last frame that is sure to be done, whether bins and anchor matter.
  void judge(const Params& params);
  /// Whether a look at what cycles change is likely to end them early: it costs a few percent of a
  /// frame. Judged by the last frame that is sure to be done.
  bool may_settle(const Params& params) const;
  const Report& report(uint64_t frame) const { return reports_[frame % reports_.size()]; }
  Report& record_report(gpu::Commands& commands, bool adaptive);
  void assemble(gpu::Commands& commands, const TemporalAnchor::Params& params, bool look);
  void solve(gpu::Commands& commands, const Params& params, bool look);
  void start_from_taken(gpu::Commands& commands, const PlanePtr& input);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  PlanePool planes_;
  Guide guide_;
  EdgePrior prior_;
  TemporalAnchor anchor_;
  ChromaBins bins_;
  Multigrid multigrid_;
  OutputGauge gauge_;
  gpu::KernelPtr terms_kernel_, anchored_terms_kernel_, looking_terms_kernel_, assemble_,
      anchored_assemble_, layers_, anchored_layers_, take_over_, total_;
  gpu::BufferPtr flux_, value_, terms_, start_, gate_sums_, gate_total_;
  std::array<Report, gpu::kFramesInFlight> reports_;
  uint64_t recorded_ = 0;
  bool history_ = false;
  bool continues_ = false;            // the frame before had one before it
  std::optional<PlanePtr> taken_;     // layers to start from
  uint64_t since_reset_ = 0;          // frames, also since params changed
  Params params_;                     // that it has been found with
  bool cleared_ = false;              // unused slots of sums
  bool binds_ = true, holds_ = true;  // what `judge` has found
  Stats stats_;                       // of the frame being recorded
};

}  // namespace inverse
