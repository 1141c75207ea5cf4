// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/edit_strokes_select_strokes.spv.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/image/strokes/stroke_mask.hpp"

namespace inverse {

/// Selects what strokes of Stroke::Kind::select cover, for other elements (thesis, 4.8): the mask
/// layer has their weight. For frames of one size.
class StrokeSelect {
 public:
  StrokeSelect(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records adding Role::mask to `layers`, which must have Role::model, or nothing if not
  /// `selects`. `strokes` are all of that kind; null: nothing is selected. Strokes that are filled
  /// extend by the unedited reflectance.
  void record(gpu::Commands& commands, Layers& layers, bool selects, const StrokesPtr& strokes,
              const StrokeMask::Places& places);
  /// Forgets how far they extend.
  void reset() { mask_.forget(); }

 private:
  Extent extent_;
  PlanePool planes_;
  StrokeMask mask_;
  gpu::Program<shaders::edit_strokes_select_strokes> select_;
};

}  // namespace inverse
