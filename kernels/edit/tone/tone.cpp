// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tone.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/edit/replace_layer.hpp"

namespace inverse {
namespace {

using Apply = shaders::edit_tone_apply;
static_assert(Apply::kMaxPoints == kMaxCurvePoints);

}  // namespace

Tone::Tone(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      planes_(device, extent),
      level_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {
  for (uint32_t i = 0; i < apply_.size(); ++i)
    apply_[i] = {device, {.matte = (i & 1) != 0, .measured = i >= 2}};
  for (uint32_t i = 0; i < measure_.size(); ++i)
    measure_[i] = {device, {.matte = i != 0}, device->variant().lone_workgroup};
}

void Tone::record(gpu::Commands& commands, Layers& layers, const ToneParams& params) {
  if (!(params.strength > 0) || is_identity(params.curve)) return reset();
  const size_t matte = params.use_mask && layers[Role::mask] ? 1 : 0;
  const bool measured = !(params.middle > 0);
  const PlanePtr edited = plane_to_edit(layers[Role::intrinsic], planes_);
  const gpu::BufferPtr& from = layers[Role::intrinsic]->buffer;
  const gpu::BufferPtr& mask = matte ? layers[Role::mask]->buffer : from;
  commands.write_table(curve_, gpu::Element::vec4, curve_knots(params.curve));
  if (measured) {
    commands.dispatch(measure_[matte], {.intrinsic = from, .mask = mask, .level = level_},
                      {.size = layers.extent, .fresh = fresh_ ? 1u : 0u}, {});
    fresh_ = false;
  } else {
    fresh_ = true;
  }
  commands.dispatch_rows(
      apply_[matte + (measured ? 2 : 0)],
      {.intrinsic = from,
       .mask = mask,
       .curve = curve_,
       .level = level_,
       .edited = gpu::by_rows(gpu::aliased(edited->buffer))},
      {.size = layers.extent,
       .middle = measured ? 0 : std::log2(std::min(params.middle, Apply::kLargest)),
       .strength = std::min(params.strength, 1.0F),
       .points = static_cast<int32_t>(std::min(params.curve.size(), kMaxCurvePoints)),
       .first_row = 0},
      {layers.extent.width, layers.extent.height, Apply::kRows});
  replace(commands, layers, Role::intrinsic, edited);
}

}  // namespace inverse
