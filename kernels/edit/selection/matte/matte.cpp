// SPDX-License-Identifier: LGPL-2.1-or-later
#include "matte.hpp"

#include <utility>

namespace inverse {
namespace {

using Shader = shaders::edit_selection_matte_matte;
static_assert(int(Combine::add) == Shader::kAdd && int(Combine::subtract) == Shader::kSubtract &&
              int(Combine::intersect) == Shader::kIntersect);

}  // namespace

Matte::Matte(const std::shared_ptr<gpu::Device>& device, const CellGrid& grid)
    : device_(device),
      grid_(grid),
      planes_(device, grid.frame),
      reduce_(device),
      classify_(device),
      sides_(device) {
  const uint64_t cells = grid.cells.pixels();
  classes_ = gpu::Buffer::create(device, gpu::Element::word, cells);
  object_ = gpu::Buffer::create(device, gpu::Element::vec4, cells);
  behind_ = gpu::Buffer::create(device, gpu::Element::vec4, cells);
  nothing_ = gpu::Buffer::create(device, gpu::Element::scalar, 1);
}

void Matte::record(gpu::Commands& commands, Layers& layers, const gpu::BufferPtr& light,
                   const Cells& cells, const Settings& settings) {
  write(commands, layers, light, cells.alpha, cells.region, nullptr, settings);
}

void Matte::record(gpu::Commands& commands, Layers& layers, const gpu::BufferPtr& light,
                   const Plane& selection, const Settings& settings) {
  if (!region_) region_ = gpu::Buffer::create(device_, gpu::Element::word, grid_.cells.pixels());
  commands.dispatch(reduce_, {.selection = selection.buffer, .region = region_},
                    {.size = grid_.frame, .cells = grid_.cells, .side = grid_.side},
                    {grid_.cells.width, grid_.cells.height});
  write(commands, layers, light, nothing_, region_, &selection, settings);
}

void Matte::write(gpu::Commands& commands, Layers& layers, const gpu::BufferPtr& light,
                  const gpu::BufferPtr& alpha, const gpu::BufferPtr& region, const Plane* selection,
                  const Settings& settings) {
  const gpu::Items per_cell{grid_.cells.width, grid_.cells.height};
  commands.dispatch(classify_, {.region = region, .classes = classes_}, {.cells = grid_.cells},
                    per_cell);
  if (settings.soft)
    commands.dispatch(sides_,
                      {.classes = classes_, .light = light, .object = object_, .behind = behind_},
                      {.cells = grid_.cells}, per_cell);
  const PlanePtr& before = layers[Role::mask];
  const gpu::BufferPtr& frame = layers[Role::input]->buffer;
  PlanePtr mask = planes_.acquire();
  // Without a mask there is nothing selected so far.
  const Combine combine = before || settings.combine == Combine::replace ? settings.combine
                          : settings.combine == Combine::add             ? Combine::replace
                                                                         : settings.combine;
  if (!before && combine != Combine::replace) {
    commands.fill(mask->buffer);
  } else {
    commands.dispatch_rows(gpu::Program<Shader>(device_, {.of_pixels = selection != nullptr,
                                                          .soft = settings.soft,
                                                          .combine = static_cast<int32_t>(combine),
                                                          .invert = settings.invert}),
                           {.frame = frame,
                            .reflectance = layers[Role::model]->buffer,
                            .alpha = alpha,
                            .classes = classes_,
                            .object = object_,
                            .behind = behind_,
                            .selection = selection ? selection->buffer : frame,
                            .mask = before ? before->buffer : frame,
                            .combined = gpu::by_rows(mask->buffer)},
                           {.size = grid_.frame,
                            .cells = grid_.cells,
                            .per_cell = 1 / static_cast<float>(grid_.side),
                            .first_row = 0},
                           {grid_.frame.width, grid_.frame.height, 1});
  }
  commands.keep(std::exchange(layers[Role::mask], std::move(mask)));
}

}  // namespace inverse
