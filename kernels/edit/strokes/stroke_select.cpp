// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_select.hpp"

namespace inverse {

StrokeSelect::StrokeSelect(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : extent_(extent), planes_(device, extent), mask_(device, extent), select_(device) {}

void StrokeSelect::record(gpu::Commands& commands, Layers& layers, bool selects,
                          const StrokesPtr& strokes, const StrokeMask::Places& places) {
  if (!strokes) mask_.forget();
  if (!selects) return;
  const PlanePtr selection = planes_.acquire();
  layers[Role::mask] = selection;
  if (!strokes) return commands.fill(selection->buffer);
  const StrokeMask::Reflectance model{.reflectance = layers[Role::model]->buffer};
  if (strokes != mask_.list() || places.tracker != mask_.tracker()) {
    mask_.set(commands, strokes, places);
    if (mask_.fills()) mask_.fill(commands, model, places.seen);
  } else if (mask_.moves()) {
    mask_.follow(commands, model, places.seen);
  }
  commands.dispatch_rows(select_,
                         {.mask = mask_.pixels(), .selection = gpu::by_rows(selection->buffer)},
                         {.size = extent_, .first_row = 0}, {extent_.width, extent_.height});
  commands.keep(layers[Role::model]);
}

}  // namespace inverse
