#include "recolor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(edit_base_key);
INVERSE_SHADER(edit_recolor);
INVERSE_SHADER(edit_recolor_base);
INVERSE_SHADER(edit_recolor_cluster);

namespace inverse {
namespace {

constexpr uint32_t kRows = 4;          // recolor.comp
constexpr float kValueFloor = 1e-3f;   // recolor.glsl
constexpr float kLargest = 65504.0f;   // edit.glsl
constexpr float kHardestEdge = 1e-6f;  // softness that stands for none
constexpr float kUnlimited = 3.4e38f;
constexpr int kMaxClusters = static_cast<int>(Palette::kMaxClusters);

struct Push {
  float target[4];
  float key[4];
  uint32_t size[2];
  float texture;
  float tolerance;
  float value_tolerance;
  float fall_off;
  int32_t clusters;
  int32_t cluster;
};

/// `value` within [low, high]; `low` where it is not a number.
float limited(float value, float low, float high) {
  return value > low ? std::min(value, high) : low;
}

Push push_of(const RecolorParams& params, Extent extent) {
  Push push{};
  float mean = 0;
  for (float k : params.key) mean += limited(k, 0, kLargest) / 3;
  for (int c = 0; c < 3; ++c) {
    push.target[c] = limited(params.target[c], 0, kLargest);
    // A black key has no chromaticity: it stands for the grays.
    push.key[c] = mean > 0 ? limited(params.key[c], 0, kLargest) / mean : 1;
  }
  push.target[3] = limited(params.strength, 0, 1);
  push.key[3] = mean + kValueFloor;
  push.size[0] = extent.width;
  push.size[1] = extent.height;
  push.texture = limited(params.texture, 0, 1);
  push.tolerance = limited(params.tolerance, 0, kLargest);
  push.value_tolerance = params.value_tolerance >= RecolorParams::kAnyValue
                             ? kUnlimited
                             : limited(params.value_tolerance, 0, RecolorParams::kAnyValue);
  push.fall_off = 1 / limited(params.softness, kHardestEdge, kLargest);
  return push;
}

}  // namespace

PlanePtr plane_to_edit(const PlanePtr& plane, PlanePool& planes) {
  return plane.use_count() == 1 ? plane : planes.acquire();
}

Recolor::Recolor(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      planes_(device, extent),
      nothing_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      no_bases_(gpu::Buffer::create(device, gpu::Element::vec4, kMaxBases, gpu::Memory::upload)),
      base_color_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      base_key_(device->kernel(shaders::edit_base_key, {}, device->variant().lone_workgroup)) {
  std::fill_n(no_bases_->map_as<float>(), 4 * kMaxBases, 0.0f);
  for (uint32_t i = 0; i < by_key_.size(); ++i) {
    by_key_[i] = device->kernel(shaders::edit_recolor, {i & 1, i >> 1});
    by_cluster_[i] = device->kernel(shaders::edit_recolor_cluster, {i & 1, i >> 1});
    by_base_[i] = device->kernel(shaders::edit_recolor_base, {i & 1, i >> 1});
  }
}

void Recolor::reset() {
  if (palette_) palette_->reset();
}

void Recolor::record(gpu::Commands& commands, Layers& layers, const RecolorParams& params) {
  if (!(params.strength > 0) && !params.write_mask) return;
  const bool by_base = params.base >= 0;
  const bool by_cluster = !by_base && params.cluster >= 0;
  const bool matte = params.use_mask && layers[Role::mask];
  // Decided before anything here refers to the plane a second time.
  const PlanePtr edited = plane_to_edit(layers[Role::intrinsic], planes_);
  const bool lights = layers.global() && params.strength > 0;
  const PlanePtr mask = params.write_mask || lights ? planes_.acquire() : nullptr;
  const gpu::BufferPtr from = layers[Role::intrinsic]->buffer;
  const size_t variant = (matte ? 1 : 0) + (mask ? 2 : 0);
  Push push = push_of(params, layers.extent);
  std::vector<gpu::BufferPtr> buffers{from, matte ? layers[Role::mask]->buffer : from,
                                      edited->buffer, mask ? mask->buffer : nothing_};
  if (by_cluster) {
    const Plane& model = *layers[Role::model];
    if (!palette_) palette_.emplace(device_, layers.extent);
    palette_->record_update(commands, model, params.clusters);
    push.clusters = palette_->palette().params().clusters;
    push.cluster = std::min(params.cluster, kMaxClusters - 1);
    buffers.insert(buffers.end(), {model.buffer, palette_->palette().colors()});
  }
  if (by_base) {
    const Role role = layers[Role::model_bases] ? Role::model_bases : Role::bases;
    const gpu::BufferPtr& model = layers[Role::model]->buffer;
    const gpu::BufferPtr& bases = layers[role] ? layers[role]->buffer : no_bases_;
    push.cluster = std::min(params.base, static_cast<int>(kMaxBases) - 1);
    const struct {
      uint32_t size[2];
      int32_t index;
      float fall_off;
    } look{{layers.extent.width, layers.extent.height}, push.cluster, push.fall_off};
    commands.dispatch(base_key_, {base_color_, model, bases}, look, {});
    buffers.insert(buffers.end(), {model, bases, base_color_});
  }
  const auto& kernels = by_base ? by_base_ : by_cluster ? by_cluster_ : by_key_;
  commands.dispatch(kernels[variant], buffers, std::as_bytes(std::span(&push, 1)),
                    {layers.extent.width, (layers.extent.height - 1) / kRows + 1});
  layers[Role::intrinsic] = edited;
  if (lights) {
    if (!light_) light_.emplace(device_, layers.extent);
    light_->repaint(commands, layers,
                    {*mask, params.key, by_cluster ? push.cluster : -1, by_base,
                     by_cluster ? palette_->palette().colors() : base_color_},
                    params.target, params.strength);
  }
  if (params.write_mask) layers[Role::mask] = mask;
}

}  // namespace inverse
