// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/palette_paint.spv.hpp"
#include "kernels/palette_pick.spv.hpp"
#include "palette.hpp"

namespace inverse {

/// The clusters of an intrinsic layer, to draw them or select one: a Palette of a sample of the
/// frame's reflectance, enough for 16 clusters at a fraction of the cost.
class ScenePalette {
 public:
  /// For intrinsic layers of this size. Throws Error(limit, out_of_memory).
  ScenePalette(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Adds a frame; `model` is (R.rgb, S), any values. `clusters` is clamped to
  /// 1…Palette::kMaxClusters; a new number restarts the search.
  void record_update(gpu::Commands& commands, const Plane& model, int clusters = 10);
  /// Writes to `target` the color of each pixel's cluster, linear, w = 1.
  void record_paint(gpu::Commands& commands, const Plane& model, const Plane& target) const;
  /// Forgets the clusters of earlier frames.
  void reset() { palette_.reset(); }

  const Palette& palette() const { return palette_; }

 private:
  Palette palette_;
  gpu::Program<shaders::palette_pick> pick_;
  gpu::Program<shaders::palette_paint> paint_;
  Plane sample_;         // ln R of some pixels
  uint32_t stride_ = 1;  // between them
};

}  // namespace inverse
