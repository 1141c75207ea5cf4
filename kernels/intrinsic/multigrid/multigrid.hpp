// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/pack4.hpp"
#include "kernels/intrinsic_multigrid_coarse.spv.hpp"
#include "kernels/intrinsic_multigrid_coarsen.spv.hpp"
#include "kernels/intrinsic_multigrid_convergence.spv.hpp"
#include "kernels/intrinsic_multigrid_extrapolate.spv.hpp"
#include "kernels/intrinsic_multigrid_restrict.spv.hpp"
#include "kernels/intrinsic_multigrid_smooth.spv.hpp"

namespace inverse {

/// Multigrid for the linear system of energy.glsl: one unknown a pixel, edges to four neighbors,
/// and terms of 4 x 4 cells that enter on level 2. Levels shrink 2:1 to a single pixel; aggregates
/// of 2 x 2 carry corrections; blocks of 4 x 4 pixels are relaxed in checkerboard order, their rows
/// solved exactly. Levels 0 and 1, and those of few pixels, which run together in one dispatch, are
/// relaxed before and after the correction from below; those between them after it only.
class Multigrid {
 public:
  struct Params {
    /// Min weight of a coarse edge, as a share of the sum of its fine edges, 0.5…1. 1 binds
    /// aggregates twice as strongly as smooth functions do; 0.5 is right for equal weights; more is
    /// slower, and safer if weights jump.
    float scale = 0.6F;
    /// Cycles over level 2 and coarser within every cycle, 1…8; the cells' right-hand side is
    /// renewed before each.
    uint32_t cell_cycles = 2;
    /// Consecutive cycles are combined so that errors of which a cycle leaves between 0 and this
    /// share shrink fastest (Chebyshev), 0…0.7; 0: not combined. From 0.8 on it diverges on some
    /// frames, because the chroma bins lag behind.
    float slowest = 0.5F;
    bool operator==(const Params&) const = default;
  };
  /// How much of the work of a frame's cycles is done.
  struct Progress {
    bool measured = false;     ///< the change by this cycle is summed
    bool last = false;         ///< no cycle follows
    bool conditional = false;  ///< skipped if the measured cycle before was the last one needed
    float tolerance = 0;       ///< rms change by a cycle, log units, below which no other is needed
  };
  static constexpr uint64_t kFineStride =
      shaders::intrinsic_multigrid_smooth::SYSTEM_FINE_STRIDE;  ///< vec4 a pack of the system on
                                                                ///< levels 0 and 1
  static constexpr uint64_t kSourceStride =
      shaders::intrinsic_multigrid_smooth::SOURCE_STRIDE;  ///< vec4 a pack of cells of
                                                           ///< `cell_source_term`
  static constexpr uint64_t kTermsStride =
      shaders::intrinsic_multigrid_smooth::TERMS_STRIDE;  ///< vec4 a pack of cells of `terms`

  /// Throws Error(limit) if a level does not fit the device.
  Multigrid(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Pixels: edges' weights to the right and down and the right-hand side, three vec4 a pack.
  const gpu::BufferPtr& system() const { return levels_[0].system; }
  /// The unknown, one vec4 a pack; cycles improve it in place.
  const gpu::BufferPtr& field() const { return levels_[0].field; }
  /// Source term, screening and anchor mass of the cells' pixels, kSourceStride vec4 a pack of
  /// cells; set before `record_operators`. Every cycle's `after` writes the source term again.
  const gpu::BufferPtr& cell_source_term() const { return cell_source_term_; }
  /// Cells, during a cycle: the mean of the unknown, its correction so far, the residual of the
  /// finer levels; and the system, whose right-hand side (SYSTEM_RHS) the caller writes.
  const gpu::BufferPtr& cell_means() const { return cell_means_; }
  const gpu::BufferPtr& cell_correction() const { return levels_[2].field; }
  const gpu::BufferPtr& cell_residual() const { return cell_residual_; }
  const gpu::BufferPtr& cell_system() const { return levels_[2].system; }

  /// Records the coarse operators, once a frame, from `system` and `cell_source_term`.
  void record_operators(gpu::Commands& commands, const Params& params) const;
  /// Records cycle number `k` of a frame, from 0; `before` records the cells' right-hand side,
  /// `after` their source term after the last correction.
  void record_cycle(gpu::Commands& commands, const Params& params, uint32_t k,
                    const Progress& progress, const std::function<void()>& before,
                    const std::function<void()>& after);
  /// One vec4, of the last measured cycle (convergence.comp), log units².
  const gpu::BufferPtr& progress() const { return progress_; }
  /// How many levels there are, the single pixel included.
  uint32_t depth() const { return depth_; }

 private:
  struct Level {
    Extent extent;
    gpu::BufferPtr system, field;
    float mass;  // of every pixel, if the system has no plane of masses
  };
  /// Relaxes a level, both colors; `corrects` adds the correction from below first.
  void relax(gpu::Commands& commands, size_t level, bool corrects) const;
  void restrict_to(gpu::Commands& commands, size_t level) const;
  void extrapolate(gpu::Commands& commands, float slowest, uint32_t k, const Progress& progress);
  void cell_cycle(gpu::Commands& commands, const Params& params) const;

  std::vector<Level> levels_;  // the last one stands for all that run in one dispatch
  uint32_t depth_ = 1;
  // On levels 0, 1, further down; between levels 0-1, 1-2, further down; and between 0-1, 1-2, 2-3,
  // further down.
  gpu::Program<shaders::intrinsic_multigrid_smooth> smooth_[2], correct_[3];
  gpu::Program<shaders::intrinsic_multigrid_coarsen> coarsen_[3];
  gpu::Program<shaders::intrinsic_multigrid_restrict> restrict_[4];
  gpu::Program<shaders::intrinsic_multigrid_extrapolate> extrapolate_, measure_;
  gpu::Program<shaders::intrinsic_multigrid_coarse> coarse_setup_, coarse_cycle_;
  gpu::Program<shaders::intrinsic_multigrid_convergence> convergence_;
  gpu::BufferPtr starts_[2];  // of this cycle and the one before
  gpu::BufferPtr sums_, progress_;
  bool cleared_ = false;
  bool keeps_start_ = false;  // the cycle recorded last leaves the start of the next one
  gpu::BufferPtr half_means_, cell_means_, cell_residual_, cell_source_term_;
};

}  // namespace inverse
