#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "../image/layers.hpp"
#include "edge_prior.hpp"
#include "multigrid.hpp"

namespace inverse {

/// Live intrinsic decomposition: reflectance and scalar shading of every frame of a video (energy.glsl). Owns the kernels
/// and the temporal state for one size on one device. Not thread-safe.
class IntrinsicDecomposition {
 public:
  struct Params {
    /// How edges share a step (the seam for other priors).
    EdgePrior::Params edges;
    /// Exponent of reflectance sparsity, 0.1…2; convex from 1 (Eq. 3.8).
    float p = 1.0F;
    /// Reflectance step below which sparsity turns quadratic, log units, 1e-3…1.
    float edge_floor = 0.02F;
    /// Weight v of the gauge prior s = max_c i, 1e-3…1e3: pins the free scale of reflectance.
    float gauge = 0.02F;
    /// Weight w_t of the temporal anchor, 0…1e3.
    float temporal = 0.1F;
    /// How fast a chroma change (log units) loosens the anchor, 0…1e3.
    float temporal_spread = 10.0F;
    /// IRLS steps of a frame without history, 1…32.
    uint32_t steps = 4;
    /// IRLS steps of a frame that continues the one before, 1…32.
    uint32_t warm_steps = 2;
    /// Multigrid cycles an IRLS step, 1…8.
    uint32_t cycles = 1;
    Multigrid::Params multigrid;
    /// Added to linear light before logarithms, of full scale, 1e-5…0.1.
    float intensity_floor = 2e-3F;
    /// The same for chroma, 1e-5…0.1: dark pixels become neutral instead of noise.
    float chroma_floor = 1e-2F;
  };

  struct Stats {
    uint32_t steps = 0;       ///< IRLS steps
    uint32_t cycles = 0;      ///< multigrid cycles
    uint32_t levels = 0;      ///< of the multigrid
    bool warm = false;        ///< started from the previous frame
    std::vector<std::string> skipped;  ///< what was left out, and why
  };

  struct FrameInfo {
    bool reset = false;  ///< no relation to the frame before
  };

  /// Throws Error(limit) where frames of this size do not fit the device.
  IntrinsicDecomposition(std::shared_ptr<gpu::Device> device, Extent extent);

  /// Records the decomposition of `input` (linear RGB, 1 = full scale; w = alpha) and returns its layers. Their planes
  /// are shared: clone before editing in place what others hold.
  Layers record(gpu::Commands& commands, const PlanePtr& input, const Params& params, const FrameInfo& info);
  /// Forgets the frames so far (flush, discontinuity).
  void reset() { history_ = false; }
  /// Of the frame recorded last.
  const Stats& stats() const { return stats_; }

 private:
  void anchor(gpu::Commands& commands, const Params& params, bool warm);
  void reweight(gpu::Commands& commands, float p, float floor);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  PlanePool planes_;
  EdgePrior prior_;
  Multigrid multigrid_;
  Guide guide_;
  Edges edges_;
  gpu::BufferPtr anchored_, control_;
  std::array<gpu::BufferPtr, 2> kept_;  // what the previous frame left, what this one leaves
  gpu::KernelPtr guide_kernel_, anchor_kernel_;
  std::array<gpu::KernelPtr, 3> reweight_kernels_;  // any p, p = 1, p = 2
  gpu::KernelPtr output_kernel_;
  bool history_ = false;
  Stats stats_;
};

}  // namespace inverse
