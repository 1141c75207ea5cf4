// SPDX-License-Identifier: LGPL-2.1-or-later
#include "returned.hpp"

#include <algorithm>
#include <bit>

#include "kernels/edit_returned.spv.hpp"
#include "replace_layer.hpp"

namespace inverse {
namespace {

using Shader = shaders::edit_returned;
using Layer = ReturnedPicture::Layer;  // in the order of the shader's constants

}  // namespace

ReturnedEdit::ReturnedEdit(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device), planes_(device, extent) {}

const PlanePtr& ReturnedEdit::filled(PlanePtr& plane, gpu::Commands& commands, float value) {
  if (!plane) {
    plane = planes_.acquire();
    commands.fill(plane->buffer, std::bit_cast<uint32_t>(value));
  }
  return plane;
}

void ReturnedEdit::record(gpu::Commands& commands, Layers& layers, const ReturnedPicture& picture,
                          float strength, const PlanePtr& matte) {
  if (!(strength > 0) || !(picture.gain > 0)) return;
  const bool mask = picture.layer == Layer::mask;
  const bool of_light = !mask && picture.layer != Layer::reflectance;
  const bool has_light = of_light && layers.global();
  const PlanePtr& slope = layers[Role::slope];
  const PlanePtr& lamp = layers[Role::lamp];
  const bool tint = of_light && (has_light || slope || !picture.gray);
  const Role role = mask ? Role::mask : Role::intrinsic;
  if (tint && !has_light)
    layers[Role::light] = layers[Role::model_light] = filled(white_, commands, 1);
  // Decided before anything here refers to the planes a second time.
  const PlanePtr edited = plane_to_edit(layers[role], planes_);
  const PlanePtr tinted = tint ? plane_to_edit(layers[Role::light], planes_) : edited;
  const gpu::BufferPtr& before = layers[role]->buffer;
  const std::array<float, 9>& m = picture.gamut.matrix;
  const auto buffer_or_before = [&](const PlanePtr& plane) {
    return plane ? plane->buffer : before;
  };
  commands.dispatch_rows(
      gpu::Program<Shader>(device_, {.layer = static_cast<uint32_t>(picture.layer),
                                     .light = has_light,
                                     .lamp = lamp != nullptr,
                                     .slope = slope != nullptr,
                                     .tint = tint,
                                     .matte = matte != nullptr,
                                     .scaled = picture.sent.extent != layers.extent,
                                     .gamut = !picture.gamut.is_identity()}),
      {.sent = picture.sent.buffer,
       .returned = picture.returned.buffer,
       .before = before,
       .light = buffer_or_before(layers[Role::light]),
       .lamp = buffer_or_before(lamp),
       .slope = buffer_or_before(slope),
       .matte = buffer_or_before(matte),
       .edited = gpu::by_rows(gpu::aliased(edited->buffer)),
       .tinted = gpu::by_rows(gpu::aliased(tinted->buffer))},
      {.red = {m[0], m[1], m[2], 0},
       .green = {m[3], m[4], m[5], 0},
       .blue = {m[6], m[7], m[8], 0},
       .size = layers.extent,
       .from = picture.sent.extent,
       .inverse_gain = 1 / picture.gain,
       .strength = std::min(strength, 1.0F),
       .first_row = 0},
      {layers.extent.width, layers.extent.height, Shader::kRows});
  replace(commands, layers, role, edited);
  if (tint) replace(commands, layers, Role::light, tinted);
}

}  // namespace inverse
