#pragma once
#include <memory>

#include "guide.hpp"

namespace inverse {

/// The non-local term: pixels of equal chroma, anywhere in the frame, pull each other towards equal reflectance. Means of
/// r = m - s over a grid of chroma (bins.glsl; docs/method-intrinsicdecomp.md, 4), in fixed point and so the same bits in
/// every run.
class ChromaBins {
 public:
  ChromaBins(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records what stays the same for a frame: `value` is EdgePrior::Target's, `most_weight` bounds its g.
  void record_frame(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& value, float most_weight);
  /// Records the means at `shading` and the right-hand side that follows, base + g (m - mean), into `system`.
  void record(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& value, const gpu::BufferPtr& base,
              const gpu::BufferPtr& shading, const gpu::BufferPtr& system) const;

 private:
  Extent extent_;
  float scale_ = 1;
  gpu::KernelPtr weigh_, splat_, mean_, slice_;
  gpu::BufferPtr weights_, totals_, sums_, means_;
};

}  // namespace inverse
