// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/thesis_chapter4_stroke_means.spv.hpp"

namespace inverse {

/// The user's strokes on a frame (thesis, 4.5).
struct ThesisStrokes {
  enum class Kind : uint8_t { shading, reflectance };
  std::vector<Kind> kinds;  ///< of each, what is constant inside
  /// Draws them on a picture of `extent` that shows the frame. Of every pixel, in rows padded to
  /// packs of four: 0, or the number of its stroke, from 1 on, plus half of its weight, 0…1. The
  /// buffer's elements are vec4; nothing else writes it.
  std::function<gpu::BufferPtr(gpu::Commands&, Extent)> draw;
};

/// Strokes on the levels of a pyramid, and their auxiliary variables (4.6.2, strokes.glsl).
class ThesisStrokeTerm {
 public:
  explicit ThesisStrokeTerm(const std::shared_ptr<gpu::Device>& device);

  void set(ThesisStrokes strokes);
  bool empty() const { return strokes_.kinds.empty(); }
  /// The levels have other sizes from now on.
  void forget_levels() { masks_.clear(); }
  /// Draws them on a level, unless that is done.
  void draw(gpu::Commands& commands, size_t level, Extent extent);
  /// Sets the auxiliary variables to where the energy of a solution (r, s) of a level is least.
  void record_means(gpu::Commands& commands, size_t level, Extent extent,
                    const gpu::BufferPtr& solution) const;

  /// Inputs of strokes.glsl; if there are no strokes, of any content.
  const gpu::BufferPtr& mask(size_t level) const { return empty() ? means_ : masks_[level]; }
  const gpu::BufferPtr& means() const { return means_; }

 private:
  std::shared_ptr<gpu::Device> device_;
  ThesisStrokes strokes_;
  gpu::Program<shaders::thesis_chapter4_stroke_means> average_;
  std::vector<gpu::BufferPtr> masks_;  // by level; null: to be drawn
  gpu::BufferPtr kinds_, means_;
};

}  // namespace inverse
