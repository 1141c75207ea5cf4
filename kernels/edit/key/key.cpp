// SPDX-License-Identifier: LGPL-2.1-or-later
#include "key.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/edit/replace_layer.hpp"

namespace inverse {
namespace {

constexpr uint32_t kRows = shaders::edit_key_matte::kRows;

/// `value` within [low, high]; `low` for NaN.
float limited(float value, float low, float high) {
  return value > low ? std::min(value, high) : low;
}

}  // namespace

CellGrid Key::grid_of(Extent extent) {
  CellGrid grid(extent);
  grid.side = std::max(grid.side, 4U);
  grid.cells = {(extent.width + grid.side - 1) / grid.side,
                (extent.height + grid.side - 1) / grid.side};
  return grid;
}

Key::Key(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      grid_(grid_of(extent)),
      planes_(device, extent),
      compose_(device, extent),
      screen_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      means_(gpu::Buffer::create(device, gpu::Element::vec4, grid_.cells.pixels())),
      behind_(pyramid()),
      front_(pyramid()),
      trust_(device),
      reduce_(device),
      spread_(device) {
  for (uint32_t i = 0; i < 2; ++i) {
    measure_[i] = {device, {.border = i != 0}, device->variant().lone_workgroup};
    cells_[i] = {device, {.front = i != 0}};
  }
  for (uint32_t i = 0; i < mattes_.size(); ++i) {
    mattes_[i] = {device, {.matte = (i & 1) != 0, .invert = i >= 2}};
    shrinks_[i] = {device, {.down = (i & 1) != 0, .grow = i >= 2}};
  }
  for (uint32_t i = 0; i < pictures_.size(); ++i)
    pictures_[i] = {device, {.over_black = (i & 1) != 0, .edited = (i & 2) != 0, .invert = i >= 4}};
}

Key::Pyramid Key::pyramid() const {
  Pyramid levels;
  for (Extent cells = grid_.cells;; cells = {(cells.width + 1) / 2, (cells.height + 1) / 2}) {
    levels.push_back({cells, gpu::Buffer::create(device_, gpu::Element::vec4, cells.pixels())});
    if (cells.pixels() == 1) return levels;
  }
}

void Key::fill(gpu::Commands& commands, const Pyramid& pyramid) {
  const Extent cells = grid_.cells;
  commands.dispatch(trust_, {.means = means_, .trusted = pyramid[0].light}, {.cells = cells},
                    {cells.width, cells.height});
  for (size_t k = 0; k + 1 < pyramid.size(); ++k) {
    const auto& [from, fine] = pyramid[k];
    const auto& [to, coarse] = pyramid[k + 1];
    commands.dispatch(reduce_, {.fine = fine, .coarse = coarse}, {.from = from, .to = to},
                      {to.width, to.height});
  }
  for (size_t k = pyramid.size() - 1; k-- > 0;) {
    const auto& [from, coarse] = pyramid[k + 1];
    const auto& [to, fine] = pyramid[k];
    commands.dispatch(spread_, {.coarse = coarse, .fine = fine}, {.from = from, .to = to},
                      {to.width, to.height});
  }
}

void Key::record(gpu::Commands& commands, Layers& layers, const KeyParams& params) {
  matte_ = shrunk_ = nullptr;
  if (!(params.strength > 0)) return reset();
  // Another key, another screen.
  fresh_ |= std::exchange(key_, params.key) != params.key;
  fresh_ |= std::exchange(of_border_, params.of_border) != params.of_border;
  const gpu::BufferPtr& frame = layers[Role::input]->buffer;
  const gpu::BufferPtr& intrinsic = layers[Role::model]->buffer;
  commands.dispatch(measure_[params.of_border ? 1 : 0], {.intrinsic = intrinsic, .screen = screen_},
                    {.size = layers.extent,
                     .key_r = limited(params.key[0], 0, 1),
                     .key_g = limited(params.key[1], 0, 1),
                     .key_b = limited(params.key[2], 0, 1),
                     .fresh = fresh_ ? 1U : 0U},
                    {});
  fresh_ = false;
  for (const bool front : {false, true}) {
    commands.dispatch(cells_[front ? 1 : 0],
                      {.frame = frame,
                       .intrinsic = intrinsic,
                       .screen = screen_,
                       .behind = front ? behind_[0].light : frame,
                       .means = means_},
                      {.size = layers.extent,
                       .cells = grid_.cells,
                       .side = grid_.side,
                       .tolerance = limited(params.tolerance, 0, 5)},
                      {grid_.cells.width, grid_.cells.height});
    fill(commands, front ? front_ : behind_);
  }
  const PlanePtr before = params.use_mask ? layers[Role::mask] : nullptr;
  matte_ = planes_.acquire();
  commands.dispatch_rows(mattes_[(before ? 1 : 0) + (params.invert ? 2 : 0)],
                         {.frame = frame,
                          .intrinsic = intrinsic,
                          .behind = behind_[0].light,
                          .front = front_[0].light,
                          .mask = before ? before->buffer : frame,
                          .matte = gpu::by_rows(matte_->buffer)},
                         {.size = layers.extent,
                          .cells = grid_.cells,
                          .per_cell = 1 / static_cast<float>(grid_.side),
                          .black = limited(params.black, 0, 1),
                          .white = limited(params.white, 0, 1),
                          .strength = std::min(params.strength, 1.0F),
                          .first_row = 0},
                         {layers.extent.width, layers.extent.height, kRows});
  const float inward = limited(params.shrink, -KeyParams::kMaxShrink, KeyParams::kMaxShrink);
  shrunk_ = shrink(commands, matte_, params.invert ? -inward : inward);
  replace(commands, layers, Role::mask, shrunk_);
}

PlanePtr Key::shrink(gpu::Commands& commands, const PlanePtr& matte, float radius) {
  if (radius == 0) return matte;
  PlanePtr from = matte;
  for (const bool down : {false, true}) {
    PlanePtr to = planes_.acquire();
    commands.dispatch_rows(shrinks_[(down ? 1 : 0) + (radius < 0 ? 2 : 0)],
                           {.matte = from->buffer, .shrunk = gpu::by_rows(to->buffer)},
                           {.size = matte->extent, .radius = std::abs(radius), .first_row = 0},
                           {matte->extent.width, matte->extent.height, 1});
    commands.keep(std::exchange(from, std::move(to)));
  }
  return from;
}

PlanePtr Key::draw(gpu::Commands& commands, const Layers& layers, const KeyParams& params,
                   bool over_black) {
  const PlanePtr composed = compose_.record(commands, layers, {});
  if (!matte_) return composed;
  PlanePtr picture = planes_.acquire();
  commands.dispatch_rows(
      pictures_[(over_black ? 1 : 0) + (composed != layers[Role::input] ? 2 : 0) +
                (params.invert ? 4 : 0)],
      {.frame = layers[Role::input]->buffer,
       .composed = composed->buffer,
       .behind = behind_[0].light,
       .front = front_[0].light,
       .matte = matte_->buffer,
       .shrunk = shrunk_->buffer,
       .picture = gpu::by_rows(picture->buffer)},
      {.size = layers.extent,
       .cells = grid_.cells,
       .per_cell = 1 / static_cast<float>(grid_.side),
       .despill = limited(params.despill, 0, 1),
       .first_row = 0},
      {layers.extent.width, layers.extent.height, kRows});
  commands.keep(composed);
  commands.keep(matte_);
  return picture;
}

}  // namespace inverse
