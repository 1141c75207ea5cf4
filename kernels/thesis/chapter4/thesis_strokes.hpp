// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/thesis_chapter4_stroke_level.spv.hpp"
#include "kernels/thesis_chapter4_stroke_means.spv.hpp"

namespace inverse {

/// The user's strokes on a frame (thesis, 4.5).
struct ThesisStrokes {
  enum class Kind : uint8_t { shading, reflectance };
  static constexpr size_t kMax = 255;
  std::vector<Kind> kinds;  ///< of each, what is constant inside; the first kMax count
  /// Of every pixel of a frame, in rows padded to packs of four: 0, or the number of its stroke,
  /// from 1 on, plus half of its weight, 0…1. Read in each frame, so that others may write it
  /// before: they draw strokes, or project them from a volume.
  gpu::BufferPtr mask;
};

/// Strokes on the levels of a pyramid, and their auxiliary variables (4.6.2, strokes.glsl).
class ThesisStrokeTerm {
 public:
  explicit ThesisStrokeTerm(const std::shared_ptr<gpu::Device>& device);

  void set(ThesisStrokes strokes);
  bool empty() const { return strokes_.kinds.empty(); }
  size_t count() const { return strokes_.kinds.size(); }
  /// Makes buffers for levels of these sizes, finest first, when they are first needed.
  void set_levels(std::vector<Extent> levels);
  /// Records the masks of all levels.
  void record_levels(gpu::Commands& commands);
  /// Records where the energy of a solution (r, s) of a level is least: the auxiliary variables.
  void record_means(gpu::Commands& commands, size_t level, const gpu::BufferPtr& solution) const;

  /// Inputs of strokes.glsl; if there are no strokes, of any content.
  const gpu::BufferPtr& mask(size_t level) const {
    return empty() ? means_ : level == 0 ? strokes_.mask : coarse_[level - 1];
  }
  const gpu::BufferPtr& means() const { return means_; }
  /// A vec4 a stroke, .x: rms of ln shading, or of ln reflectance, from its mean in that solution.
  const gpu::BufferPtr& spreads() const { return spreads_; }

 private:
  std::shared_ptr<gpu::Device> device_;
  gpu::Program<shaders::thesis_chapter4_stroke_level> coarsen_;
  gpu::Program<shaders::thesis_chapter4_stroke_means> average_;
  std::vector<Extent> levels_;
  ThesisStrokes strokes_;
  gpu::BufferPtr kinds_, means_, spreads_;
  std::vector<gpu::BufferPtr> coarse_;  // masks of the levels after the first
};

}  // namespace inverse
