// SPDX-License-Identifier: LGPL-2.1-or-later
#include "selection.hpp"

namespace inverse {

Selection::Selection(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      grid_(extent),
      light_of_(device, {.colors = false}),
      colors_of_(device, {.colors = true}),
      light_(gpu::Buffer::create(device, gpu::Element::vec4, grid_.cells.pixels())),
      colors_(gpu::Buffer::create(device, gpu::Element::vec4, grid_.cells.pixels())),
      matte_(device, grid_) {}

void Selection::reset() {
  if (object_) object_->reset();
  if (recolor_) recolor_->reset();
}

void Selection::lose(gpu::Commands& commands) {
  if (object_) object_->lose(commands);
  if (recolor_) recolor_->reset();
}

ObjectSelection::State Selection::save(gpu::Commands& commands) {
  return object_ ? object_->save(commands) : ObjectSelection::State{};
}

void Selection::restore(gpu::Commands& commands, const ObjectSelection::State& state) {
  if (object_) object_->restore(commands, state);
}

void Selection::record(gpu::Commands& commands, Layers& layers, const SelectionParams& params,
                       const Strokes& strokes, const Plane* picture) {
  if (params.by == SelectBy::strokes) {
    if (!object_) object_.emplace(device_, grid_);
    if (strokes.restart) object_->reset();
    if (!strokes.strokes.empty() || object_->active()) {
      find_cells(commands, layers, true);
      if (strokes.strokes.empty())
        object_->follow(commands, colors_);
      else
        object_->select(commands, colors_, strokes.strokes, strokes.drawn, strokes.restart);
      return matte_.record(commands, layers, light_, {object_->alpha(), object_->region()}, params);
    }
    picture = nullptr;
  } else if (params.by != SelectBy::picture) {
    if (!recolor_) recolor_.emplace(device_, grid_.frame);
    RecolorParams color = params.color;
    color.strength = 0;
    color.use_mask = false;
    color.write_mask = true;
    if (params.by != SelectBy::base_color) color.base = RecolorParams::kByKey;
    if (params.by != SelectBy::cluster) color.cluster = RecolorParams::kByKey;
    Layers unedited = layers;
    unedited[Role::intrinsic] = layers[Role::model];
    recolor_->record(commands, unedited, color);
    find_cells(commands, layers, false);
    const PlanePtr selected = unedited[Role::mask];
    matte_.record(commands, layers, light_, *selected, params);
    commands.keep(selected);
    return;
  }
  if (!picture && !nothing_) {
    nothing_ = std::make_shared<Plane>(
        Plane{grid_.frame, gpu::Buffer::create(device_, gpu::Element::vec4, grid_.frame.pixels())});
    commands.fill(nothing_->buffer);
  }
  if (!picture && !params.invert && params.combine == Combine::replace) {
    layers[Role::mask] = nothing_;
    return;
  }
  find_cells(commands, layers, false);
  matte_.record(commands, layers, light_, picture ? *picture : *nothing_, params);
}

void Selection::find_cells(gpu::Commands& commands, const Layers& layers, bool colors) {
  commands.dispatch(colors ? colors_of_ : light_of_,
                    {.reflectance = layers[Role::model]->buffer,
                     .frame = layers[Role::input]->buffer,
                     .light = light_,
                     .colors = colors_},
                    {.size = grid_.frame, .cells = grid_.cells, .side = grid_.side},
                    {grid_.cells.width, grid_.cells.height});
}

}  // namespace inverse
