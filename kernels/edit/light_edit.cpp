// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_edit.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "replace_layer.hpp"

namespace inverse {
namespace {

using Bases = shaders::edit_bases;
constexpr uint32_t kRows = shaders::edit_retint::kRows;
constexpr float kLargest = Bases::kLargest;
constexpr float kHardestEdge = 1e-6f;

/// `value` within [low, high]; `low` for NaN.
float limited(float value, float low, float high) {
  return value > low ? std::min(value, high) : low;
}

std::array<float, 4> color_and(const std::array<float, 3>& color, float fourth) {
  return {limited(color[0], 0, kLargest), limited(color[1], 0, kLargest),
          limited(color[2], 0, kLargest), fourth};
}

}  // namespace

LightEdit::LightEdit(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      planes_(device, extent),
      bases_(device, {kMaxBases, 1}),
      change_(gpu::Buffer::create(device, gpu::Element::vec4, kMaxBases)) {}

void LightEdit::repaint(gpu::Commands& commands, Layers& layers, const Surfaces& surfaces,
                        const std::array<float, 3>& target, float strength) {
  const uint32_t by = surfaces.by_base        ? Bases::kByBasesSurface
                      : surfaces.cluster >= 0 ? Bases::kByClustersSurface
                                              : Bases::kBySurface;
  run(commands, layers, by,
      {.key = color_and(surfaces.key, 0),
       .target = color_and(target, limited(strength, 0, 1)),
       .size = layers.extent,
       .fall_off = 0,
       .index = surfaces.by_base ? 0 : surfaces.cluster},
      {.selection = &surfaces.selection, .keys = surfaces.keys});
}

void LightEdit::change(gpu::Commands& commands, Layers& layers, const Key& key,
                       const std::array<float, 3>& target, float strength, const Plane* matte) {
  run(commands, layers, Bases::kByKey,
      {.key = color_and(key.color, limited(key.tolerance, 0, kLargest)),
       .target = color_and(target, limited(strength, 0, 1)),
       .size = layers.extent,
       .fall_off = 1 / limited(key.softness, kHardestEdge, kLargest),
       .index = 0},
      {.matte = matte});
}

void LightEdit::change(gpu::Commands& commands, Layers& layers, uint32_t base,
                       const std::array<float, 3>& target, float strength, const Plane* matte) {
  run(commands, layers, Bases::kByIndex,
      {.key = {0, 0, 0, 0},
       .target = color_and(target, limited(strength, 0, 1)),
       .size = layers.extent,
       .fall_off = 0,
       .index = static_cast<int32_t>(base < kMaxBases ? base : kMaxBases)},
      {.matte = matte});
}

void LightEdit::run(gpu::Commands& commands, Layers& layers, uint32_t by, const Push& push,
                    const Inputs& inputs) {
  if (!layers.global() || !layers[Role::model])
    throw Error(ErrorKind::internal, "light that has no layers cannot be edited");
  uint32_t planes = 0;
  while (planes < kIndirectPlanes && layers[indirect_role(planes)]) ++planes;
  if (!layers[Role::bases] || planes == 0) return;  // nothing bounced
  const gpu::Program<Bases> choose(device_, {.by = by}, device_->variant().lone_workgroup);
  const gpu::Program<shaders::edit_retint> retint(
      device_, {.matte = inputs.matte != nullptr, .planes = static_cast<int32_t>(planes)});
  const gpu::BufferPtr& model = layers[Role::model]->buffer;
  const PlanePtr edited = bases_.acquire();
  const PlanePtr& before = layers[layers[Role::model_bases] ? Role::model_bases : Role::bases];
  commands.dispatch(choose,
                    {.bases = layers[Role::bases]->buffer,
                     .model = model,
                     .selection = inputs.selection ? inputs.selection->buffer : model,
                     .keys = inputs.keys ? inputs.keys : model,
                     .model_bases = before->buffer,
                     .edited = edited->buffer,
                     .change = change_,
                     .light = layers[Role::model_light]->buffer},
                    push, {});
  const PlanePtr light = plane_to_edit(layers[Role::light], planes_);
  const auto share = [&](uint32_t n) { return layers[indirect_role(n < planes ? n : 0)]->buffer; };
  const gpu::BufferPtr& from = layers[Role::light]->buffer;
  commands.dispatch_rows(retint,
                         {.light = from,
                          .share0 = share(0),
                          .share1 = share(1),
                          .share2 = share(2),
                          .share3 = share(3),
                          .change = change_,
                          .mask = inputs.matte ? inputs.matte->buffer : from,
                          .edited = gpu::by_rows(gpu::aliased(light->buffer))},
                         {.size = layers.extent, .first_row = 0},
                         {layers.extent.width, layers.extent.height, kRows});
  replace(commands, layers, Role::light, light);
  if (!inputs.matte) replace(commands, layers, Role::bases, edited);
}

}  // namespace inverse
