// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_chroma_bin_means.spv.hpp"
#include "kernels/intrinsic_chroma_bin_slice.spv.hpp"
#include "kernels/intrinsic_chroma_bin_splat.spv.hpp"
#include "kernels/intrinsic_chroma_source_term.spv.hpp"
#include "kernels/solve_total.spv.hpp"

namespace inverse {

/// The non-local term: draws cells of equal chroma, anywhere in the frame, to equal reflectance, by
/// means of r = m' - s' over a grid of chroma (bins.glsl;
/// docs/reference/methods/intrinsicdecomp.md, 4). In fixed point: equal bits in every run.
class ChromaBins {
 public:
  /// `cells` is the size of guide level 2.
  ChromaBins(const std::shared_ptr<gpu::Device>& device, Extent cells);

  /// Records the weights of the bins, which are constant for a frame. `max_weight` bounds the g in
  /// `terms`; if it is 0, the frame has no bins.
  void record_weights(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& terms,
                      float max_weight);
  /// Buffers of the solution that the means are taken of, and of the right-hand side that follows.
  struct State {
    gpu::BufferPtr terms, means, correction, far, system, source_term;
  };
  /// Records the means and the right-hand side for a correction.
  void record(gpu::Commands& commands, const Guide& guide, const State& state) const;
  /// Records the source term after a correction, and with `measure` measures `binding`.
  void record_source_term(gpu::Commands& commands, const State& state, bool measure = false);
  /// One vec4, of the last measurement: sums over the cells (source_term.comp), F the source term
  /// of the bins and v the weight of the value prior. The root of their ratio bounds
  /// the effect of the bins on cell means of log shading, rms weighted by v
  /// (docs/reference/methods/intrinsicdecomp.md, 4).
  const gpu::BufferPtr& binding() const { return binding_; }

 private:
  gpu::Items splat_items() const;
  void clear_once(gpu::Commands& commands);

  Extent cells_;
  uint32_t tables_;
  float scale_ = 1;
  bool on_ = true;
  gpu::Program<shaders::intrinsic_chroma_bin_splat> weigh_, splat_;
  gpu::Program<shaders::intrinsic_chroma_bin_means> sum_weights_, mean_;
  gpu::Program<shaders::intrinsic_chroma_bin_slice> slice_, without_bins_;
  gpu::Program<shaders::intrinsic_chroma_source_term> source_term_, measuring_source_term_;
  gpu::Program<shaders::solve_total> total_;
  gpu::BufferPtr table_sums_, weights_, means_, target_, sums_, binding_;
  bool cleared_ = false;  // table_sums_, and the unused slots of sums_
};

}  // namespace inverse
