// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_recolor.hpp"

#include "kernels/edit/replace_layer.hpp"
#include "kernels/image/pack4.hpp"

namespace inverse {

StrokeRecolor::StrokeRecolor(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      planes_(device, extent),
      mask_(device, extent),
      recolor_(device),
      select_(device),
      average_(device, {}, device->variant().area_workgroup()) {}

void StrokeRecolor::record(gpu::Commands& commands, Layers& layers, const StrokesPtr& strokes,
                           const StrokeMask::Places& places) {
  if (!strokes) return mask_.forget();
  const StrokeMask::Reflectance model{.reflectance = layers[Role::model]->buffer};
  if (strokes != mask_.list() || places.tracker != mask_.tracker()) {
    mask_.set(commands, strokes, places);
    if (mask_.fills()) mask_.fill(commands, model, places.seen);
  } else if (mask_.moves()) {
    mask_.follow(commands, model, places.seen);
  }
  const PlanePtr edited = plane_to_edit(layers[Role::intrinsic], planes_);
  commands.dispatch_rows(recolor_,
                         {.intrinsic = layers[Role::intrinsic]->buffer,
                          .mask = mask_.pixels(),
                          .strokes = mask_.strokes(),
                          .edited = gpu::by_rows(gpu::aliased(edited->buffer))},
                         {.size = extent_, .first_row = 0}, {extent_.width, extent_.height});
  replace(commands, layers, Role::intrinsic, edited);
  if (layers.global() && layers[Role::bases]) repaint(commands, layers);
  commands.keep(layers[Role::model]);
}

void StrokeRecolor::repaint(gpu::Commands& commands, Layers& layers) {
  if (!light_) {
    light_.emplace(device_, extent_);
    colors_ = gpu::Buffer::create(device_, gpu::Element::vec4, kMaxStrokes);
    key_ = gpu::Buffer::create(device_, gpu::Element::vec4, 1);
  }
  commands.dispatch(average_,
                    {.mask = mask_.pixels(),
                     .strokes = mask_.strokes(),
                     .reflectance = layers[Role::model]->buffer,
                     .colors = colors_},
                    {.size = extent_},
                    line_of(uint64_t{mask_.count()} * average_.kernel()->workgroup()));
  for (uint32_t i = 0; i < mask_.count(); ++i) {
    const PlanePtr selection = planes_.acquire();
    commands.dispatch_rows(
        select_, {.mask = mask_.pixels(), .selection = gpu::by_rows(selection->buffer)},
        {.size = extent_, .first_row = 0, .stroke = i}, {extent_.width, extent_.height});
    commands.copy(colors_, key_, gpu::element_bytes(gpu::Element::vec4),
                  gpu::element_bytes(gpu::Element::vec4) * uint64_t{i});
    light_->repaint(commands, layers, {.selection = *selection, .by_base = true, .keys = key_},
                    mask_.list()->strokes[i].color, 1);
    commands.keep(selection);
  }
}

}  // namespace inverse
