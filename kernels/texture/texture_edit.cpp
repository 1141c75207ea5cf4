// SPDX-License-Identifier: LGPL-2.1-or-later
#include "texture_edit.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/edit/replace_layer.hpp"

namespace inverse {
namespace {

using Draw = shaders::texture_draw;
constexpr float kHardestEdge = 1e-6f;

/// `value` within [low, high]; `low` for NaN.
float limited(float value, float low, float high) {
  return value > low ? std::min(value, high) : low;
}

std::array<gpu::Vector<float, 4>, 3> rows_of(const Homography& h) {
  const auto row = [&](size_t k) -> std::array<float, 4> {
    return {static_cast<float>(h[3 * k]), static_cast<float>(h[3 * k + 1]),
            static_cast<float>(h[3 * k + 2]), 0};
  };
  return {row(0), row(1), row(2)};
}

double distance(const Point& a, const Point& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

}  // namespace

TextureEdit::TextureEdit(const std::shared_ptr<gpu::Device>& device, Extent frame)
    : device_(device),
      planes_(device, frame),
      compare_(device),
      hide_(device),
      learn_(device),
      soften_(device),
      softened_(gpu::Buffer::create(device, gpu::Element::scalar, 1)) {
  for (uint32_t i = 0; i < draw_.size(); ++i)
    draw_[i] = {device, {.matte = (i & 1) != 0, .hidden = i > 1}};
}

Extent TextureEdit::cells_of(const Corners& corners) {
  constexpr double kCell = 2;  // pixels
  const auto count = [](double pixels) {
    return static_cast<uint32_t>(std::clamp(pixels / kCell, 4.0, double{kMaxCells}));
  };
  return {count(std::max(distance(corners[0], corners[1]), distance(corners[3], corners[2]))),
          count(std::max(distance(corners[0], corners[3]), distance(corners[1], corners[2])))};
}

void TextureEdit::compare(gpu::Commands& commands, const Layers& layers, const Corners& corners,
                          const TextureParams& params) {
  if (cells_.pixels() == 0) {
    cells_ = cells_of(corners);
    const uint64_t count = cells_.pixels();
    learned_ = gpu::Buffer::create(device_, gpu::Element::vec4, 2 * count);
    observed_ = gpu::Buffer::create(device_, gpu::Element::vec4, count);
    for (gpu::BufferPtr* buffer : {&excess_, &hidden_, &softened_})
      *buffer = gpu::Buffer::create(device_, gpu::Element::scalar, count);
    commands.fill(learned_);
  }
  const gpu::Items cells(static_cast<uint32_t>(cells_.pixels()));
  constexpr float kMaxDifference = 100;
  commands.dispatch(
      compare_,
      {.model = layers[Role::model]->buffer,
       .learned = learned_,
       .observed = observed_,
       .excess = excess_},
      {.to_frame = rows_of(square_to(corners)), .size = layers.extent, .cells = cells_}, cells);
  commands.dispatch(hide_, {.excess = excess_, .hidden = hidden_},
                    {.cells = cells_,
                     .tolerance = limited(params.tolerance, 0, kMaxDifference),
                     .fall_off = 1 / limited(params.softness, kHardestEdge, kMaxDifference)},
                    cells);
  commands.dispatch(learn_, {.observed = observed_, .hidden = hidden_, .learned = learned_},
                    {.cells = cells_}, cells);
  commands.dispatch(soften_, {.hidden = hidden_, .softened = softened_}, {.cells = cells_}, cells);
}

void TextureEdit::record(gpu::Commands& commands, Layers& layers, const TexturePyramid& picture,
                         const Corners& corners, const TextureParams& params) {
  if (!(params.opacity > 0)) return;
  if (params.occlusion) compare(commands, layers, corners, params);
  const bool matte = params.use_mask && layers[Role::mask];
  const PlanePtr edited = plane_to_edit(layers[Role::intrinsic], planes_);
  const gpu::BufferPtr from = layers[Role::intrinsic]->buffer;
  // A plane that is edited in place keeps its other rows.
  gpu::Rows rows{layers.extent.width, layers.extent.height, Draw::kRows};
  if (edited == layers[Role::intrinsic]) {
    const auto [top, bottom] = std::minmax_element(
        corners.begin(), corners.end(), [](const Point& a, const Point& b) { return a[1] < b[1]; });
    const double last = layers.extent.height;
    rows.begin = static_cast<uint32_t>(std::clamp((*top)[1] - 1, 0.0, last));
    rows.end = static_cast<uint32_t>(std::clamp((*bottom)[1] + 2, 0.0, last));
  }
  commands.dispatch_rows(draw_[(matte ? 1 : 0) + (params.occlusion ? 2 : 0)],
                         {.intrinsic = from,
                          .mask = matte ? layers[Role::mask]->buffer : from,
                          .pyramid = picture.buffer(),
                          .hidden = softened_,
                          .edited = gpu::by_rows(gpu::aliased(edited->buffer))},
                         {.to_plane = rows_of(to_square(corners)),
                          .size = layers.extent,
                          .picture = picture.extent(),
                          .cells = cells_,
                          .levels = picture.levels(),
                          .white = limited(params.white, 0, Draw::kLargest),
                          .opacity = limited(params.opacity, 0, 1),
                          .first_row = 0},
                         rows);
  replace(commands, layers, Role::intrinsic, edited);
}

}  // namespace inverse
