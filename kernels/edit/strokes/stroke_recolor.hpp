// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>

#include "kernels/edit/light_edit.hpp"
#include "kernels/edit_strokes_recolor_strokes.spv.hpp"
#include "kernels/edit_strokes_select_stroke.spv.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/image/strokes/stroke_mask.hpp"

namespace inverse {

/// Gives surfaces under strokes of Stroke::Kind::recolor a fixed reflectance (thesis, 4.5):
/// R' = R + w (color - R), w the stroke's weight. Light that bounced off them takes their color,
/// too (LightEdit). For frames of one size.
class StrokeRecolor {
 public:
  StrokeRecolor(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the edit of `layers`, which must have Role::intrinsic and Role::model, by strokes that
  /// are all of that kind; null: none. Planes that others hold are not written. Strokes that are
  /// filled extend by the unedited reflectance.
  void record(gpu::Commands& commands, Layers& layers, const StrokesPtr& strokes,
              const StrokeMask::Places& places);
  /// Forgets how far they extend.
  void reset() { mask_.forget(); }

 private:
  void repaint(gpu::Commands& commands, Layers& layers);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  PlanePool planes_;
  StrokeMask mask_;
  gpu::Program<shaders::edit_strokes_recolor_strokes> recolor_;
  gpu::Program<shaders::edit_strokes_select_stroke> select_;
  gpu::Program<shaders::image_strokes_colors> average_;
  std::optional<LightEdit> light_;  // made when light first has layers
  gpu::BufferPtr colors_, key_;
};

}  // namespace inverse
