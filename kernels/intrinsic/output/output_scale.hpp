// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_output_count_brightness.spv.hpp"
#include "kernels/intrinsic_output_target_scale.spv.hpp"
#include "kernels/solve/scale_normalization.hpp"

namespace inverse {

/// The scale of the layers of IntrinsicDecomposition: ScaleNormalization on its cells. The scale of
/// a frame alone comes from a quantile of max_c R.
class OutputScale {
 public:
  struct Params {
    /// Quantile of max_c R over the cells of a first frame, 0…1, that …
    float white_quantile = 0.98F;
    /// … is mapped to this value, 0.05…1 (1 = white of the display).
    float white_level = 0.9F;
    bool operator==(const Params&) const = default;
  };
  using History = ScaleNormalization::History;
  /// `cells`: of the guide.
  OutputScale(const std::shared_ptr<gpu::Device>& device, Extent cells);

  /// Records finding the scale for `shading`, the solution in packs of four. `decision` is
  /// TemporalAnchor's cut_decision, which counts with History::decided. `light`: the guide's, or
  /// null.
  void record(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& shading,
              const gpu::BufferPtr& decision, History history, const Params& params,
              const gpu::BufferPtr& light = nullptr);
  /// Records taking over the scale of another size.
  void take(gpu::Commands& commands, const OutputScale& other);
  /// As ScaleNormalization::value: ln c first.
  const gpu::BufferPtr& value() const { return normalization_.value(); }

 private:
  ScaleNormalization normalization_;
  gpu::Program<shaders::intrinsic_output_count_brightness> count_;
  gpu::Program<shaders::intrinsic_output_target_scale> target_kernel_;
  gpu::BufferPtr counts_, target_;
  bool cleared_ = false;
};

}  // namespace inverse
