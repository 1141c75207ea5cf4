// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic_output_count_brightness.spv.hpp"
#include "kernels/intrinsic_output_wanted_scale.spv.hpp"
#include "kernels/solve/scale_normalization.hpp"

namespace inverse {

/// The scale in which the layers of IntrinsicDecomposition go out: ScaleNormalization on its cells,
/// with what a frame alone asks for from a quantile of max_c R.
class OutputScale {
 public:
  struct Params {
    /// Quantile of max_c R over the cells of a first frame, 0…1, that …
    float quantile = 0.98F;
    /// … comes to this value, 0.05…1 (1 = the brightest that a display shows).
    float white_level = 0.9F;
    bool operator==(const Params&) const = default;
  };
  using History = ScaleNormalization::History;
  /// `cells`: of the guide.
  OutputScale(const std::shared_ptr<gpu::Device>& device, Extent cells);

  /// Records finding the scale for `shading`, the solution in packs of four. `decision` is
  /// TemporalAnchor's verdict, which counts with History::decided. `frozen`: the scale stays.
  void record(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& shading,
              const gpu::BufferPtr& decision, History history, const Params& params,
              bool frozen = false);
  /// Records taking over the scale of another size.
  void take(gpu::Commands& commands, const OutputScale& other);
  /// As ScaleNormalization::value: ln c first.
  const gpu::BufferPtr& value() const { return normalization_.value(); }

 private:
  ScaleNormalization normalization_;
  gpu::Program<shaders::intrinsic_output_count_brightness> count_;
  gpu::Program<shaders::intrinsic_output_wanted_scale> wanted_kernel_;
  gpu::BufferPtr counts_, wanted_;
  bool cleared_ = false;
};

}  // namespace inverse
