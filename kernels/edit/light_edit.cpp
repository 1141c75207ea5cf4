#include "light_edit.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "kernels/gpu/shaders.hpp"
#include "recolor.hpp"

INVERSE_SHADER(edit_bases);
INVERSE_SHADER(edit_retint);

namespace inverse {
namespace {

constexpr uint32_t kRows = 4;  // edit.glsl
constexpr uint32_t kBySurface = 0, kByKey = 1, kByIndex = 2, kByClustersSurface = 3,
                   kByBasesSurface = 4;  // bases.comp
constexpr float kLargest = 65504.0f;     // edit.glsl
constexpr float kHardestEdge = 1e-6f;

/// `value` within [low, high]; `low` where it is not a number.
float limited(float value, float low, float high) {
  return value > low ? std::min(value, high) : low;
}

}  // namespace

struct LightEdit::Push {
  float key[4], aim[4];
  uint32_t size[2];
  float fall_off;
  int32_t index;

  Push(const std::array<float, 3>& key_color, const std::array<float, 3>& aim_color, float strength,
       Extent extent)
      : key{}, aim{}, size{extent.width, extent.height}, fall_off(0), index(0) {
    for (size_t c = 0; c < 3; ++c) {
      key[c] = limited(key_color[c], 0, kLargest);
      aim[c] = limited(aim_color[c], 0, kLargest);
    }
    aim[3] = limited(strength, 0, 1);
  }
};

LightEdit::LightEdit(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      planes_(device, extent),
      bases_(device, {kMaxBases, 1}),
      change_(gpu::Buffer::create(device, gpu::Element::vec4, kMaxBases)) {}

void LightEdit::repaint(gpu::Commands& commands, Layers& layers, const Surfaces& surfaces,
                        const std::array<float, 3>& aim, float strength) {
  Push push(surfaces.key, aim, strength, layers.extent);
  push.index = surfaces.by_base ? 0 : surfaces.cluster;
  const uint32_t by = surfaces.by_base        ? kByBasesSurface
                      : surfaces.cluster >= 0 ? kByClustersSurface
                                              : kBySurface;
  run(commands, layers, by, push, {.selection = &surfaces.selection, .keys = surfaces.keys});
}

void LightEdit::change(gpu::Commands& commands, Layers& layers, const Key& key,
                       const std::array<float, 3>& aim, float strength, const Plane* matte) {
  Push push(key.color, aim, strength, layers.extent);
  push.key[3] = limited(key.tolerance, 0, kLargest);
  push.fall_off = 1 / limited(key.softness, kHardestEdge, kLargest);
  run(commands, layers, kByKey, push, {.matte = matte});
}

void LightEdit::change(gpu::Commands& commands, Layers& layers, uint32_t base,
                       const std::array<float, 3>& aim, float strength, const Plane* matte) {
  Push push({}, aim, strength, layers.extent);
  push.index = static_cast<int32_t>(base < kMaxBases ? base : kMaxBases);
  run(commands, layers, kByIndex, push, {.matte = matte});
}

void LightEdit::run(gpu::Commands& commands, Layers& layers, uint32_t by, const Push& push,
                    const Inputs& inputs) {
  if (!layers.global() || !layers[Role::model])
    throw Error(ErrorKind::internal, "light that has no layers cannot be edited");
  uint32_t planes = 0;
  while (planes < kIndirectPlanes && layers[indirect_role(planes)]) ++planes;
  if (!layers[Role::bases] || planes == 0) return;  // nothing bounced
  gpu::KernelPtr& choose = choose_[by];
  if (!choose)
    choose = device_->kernel(shaders::edit_bases, {by}, device_->variant().lone_workgroup);
  const gpu::KernelPtr retint =
      device_->kernel(shaders::edit_retint, {inputs.matte ? 1U : 0U, planes});
  const gpu::BufferPtr& model = layers[Role::model]->buffer;
  const PlanePtr edited = bases_.acquire();
  const PlanePtr& before = layers[layers[Role::model_bases] ? Role::model_bases : Role::bases];
  commands.dispatch(
      choose,
      {layers[Role::bases]->buffer, model, inputs.selection ? inputs.selection->buffer : model,
       inputs.keys ? inputs.keys : model, before->buffer, edited->buffer, change_,
       layers[Role::model_light]->buffer},
      push, {});
  const PlanePtr light = plane_to_edit(layers[Role::light], planes_);
  const auto share = [&](uint32_t n) { return layers[indirect_role(n < planes ? n : 0)]->buffer; };
  const gpu::BufferPtr& from = layers[Role::light]->buffer;
  const std::array<uint32_t, 2> size{layers.extent.width, layers.extent.height};
  commands.dispatch(retint,
                    {from, share(0), share(1), share(2), share(3), change_,
                     inputs.matte ? inputs.matte->buffer : from, light->buffer},
                    size, {layers.extent.width, (layers.extent.height - 1) / kRows + 1});
  layers[Role::light] = light;
  if (!inputs.matte) layers[Role::bases] = edited;
}

}  // namespace inverse
