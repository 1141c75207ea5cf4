// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stylize.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/edit/replace_layer.hpp"

namespace inverse {
namespace {

using Apply = shaders::edit_stylize_apply;
constexpr float kMaxFlattenSigma = 6;  // pixels: its cost is bounded
constexpr float kReach = 2;            // radius of the bilateral filter, in sigma

/// `value` within [low, high]; `low` for NaN.
float limited(float value, float low, float high) {
  return value > low ? std::min(value, high) : low;
}

}  // namespace

Stylize::Stylize(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      planes_(device, extent),
      nothing_(gpu::Buffer::create(device, gpu::Element::scalar, 1)),
      gaussians_(device, extent) {
  for (uint32_t i = 0; i < apply_.size(); ++i)
    apply_[i] = {device,
                 {.matte = (i & 1) != 0, .shades = (i & 2) != 0, .flattened = (i & 4) != 0}};
  for (uint32_t i = 0; i < flatten_.size(); ++i) flatten_[i] = {device, {.down = i != 0}};
}

PlanePtr Stylize::flatten(gpu::Commands& commands, const Plane& intrinsic, float sigma,
                          float difference) {
  const PlanePtr half = planes_.acquire();
  PlanePtr flat = planes_.acquire();
  const Extent extent = intrinsic.extent;
  const shaders::edit_stylize_flatten::Push push{
      .size = extent,
      .radius = static_cast<int32_t>(std::ceil(kReach * sigma)),
      .fall_off = 1 / (2 * sigma * sigma),
      .range_scale = 1 / (2 * difference * difference),
      .first_row = 0};
  const gpu::Rows rows{extent.width, extent.height, 1};
  commands.dispatch_rows(flatten_[0],
                         {.intrinsic = intrinsic.buffer, .flattened = gpu::by_rows(half->buffer)},
                         push, rows);
  commands.dispatch_rows(flatten_[1],
                         {.intrinsic = half->buffer, .flattened = gpu::by_rows(flat->buffer)}, push,
                         rows);
  return flat;
}

void Stylize::record(gpu::Commands& commands, Layers& layers, const StylizeParams& params) {
  const float sensitivity = limited(params.sensitivity, 0, 1000);
  const float levels = limited(params.levels, 0, StylizeParams::kMaxLevels);
  const float difference = limited(params.flatten, 0, 10);
  const bool shades = (sensitivity > 0 && params.sharpness > 0) || levels > 0;
  const bool flattens = difference > 0;
  if (!(params.strength > 0) || !(shades || flattens)) return;
  const bool matte = params.use_mask && layers[Role::mask];
  const float sigma = limited(params.scale, StylizeParams::kMinScale, StylizeParams::kMaxScale);
  const PlanePtr edited = plane_to_edit(layers[Role::intrinsic], planes_);
  const PlanePtr& from = layers[Role::intrinsic];
  if (shades) gaussians_.record(commands, *from, sigma);
  const PlanePtr flat =
      flattens ? flatten(commands, *from, std::min(2 * sigma, kMaxFlattenSigma), difference) : from;
  commands.dispatch_rows(apply_[(matte ? 1 : 0) + (shades ? 2 : 0) + (flattens ? 4 : 0)],
                         {.intrinsic = from->buffer,
                          .mask = matte ? layers[Role::mask]->buffer : from->buffer,
                          .flattened = flat->buffer,
                          .near = shades ? gaussians_.near() : nothing_,
                          .wide = shades ? gaussians_.wide() : nothing_,
                          .edited = gpu::by_rows(gpu::aliased(edited->buffer))},
                         {.size = layers.extent,
                          .grid = shades ? gaussians_.cells() : Extent{1, 1},
                          .cells = shades ? 1 / static_cast<float>(gaussians_.factor()) : 1,
                          .sensitivity = sensitivity,
                          .sharpness = limited(params.sharpness, 0, 1000),
                          .levels = levels,
                          .softness = limited(params.softness, 0, 1),
                          .strength = std::min(params.strength, 1.0F),
                          .first_row = 0},
                         {layers.extent.width, layers.extent.height, Apply::kRows});
  replace(commands, layers, Role::intrinsic, edited);
}

}  // namespace inverse
