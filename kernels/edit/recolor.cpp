// SPDX-License-Identifier: LGPL-2.1-or-later
#include "recolor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "replace_layer.hpp"

namespace inverse {
namespace {

using Push = shaders::edit_recolor::Push;
constexpr uint32_t kRows = shaders::edit_recolor::kRows;
constexpr float kLargest = shaders::edit_recolor::kLargest;
constexpr float kHardestEdge = 1e-6f;  // softness of a hard edge
constexpr float kUnlimited = 3.4e38f;
constexpr float kMaskRate = 0.2f;  // of the mean color of masks, a frame
constexpr int kMaxClusters = static_cast<int>(Palette::kMaxClusters);
static_assert(kMaxClusters == shaders::edit_recolor::kMaxClusters &&
              kMaxBases == shaders::edit_recolor::kMaxBases);

/// `value` within [low, high]; `low` for NaN.
float limited(float value, float low, float high) {
  return value > low ? std::min(value, high) : low;
}

Push push_of(const RecolorParams& params, Extent extent) {
  float mean = 0;
  for (float k : params.key) mean += limited(k, 0, kLargest) / 3;
  const auto target = [&](size_t c) { return limited(params.target[c], 0, kLargest); };
  // A black key has no chromaticity: it selects grays.
  const auto key = [&](size_t c) {
    return mean > 0 ? limited(params.key[c], 0, kLargest) / mean : 1;
  };
  const float angle = std::isfinite(params.hue_shift) ? params.hue_shift * 0.017453293f : 0;
  return {.target = {target(0), target(1), target(2), limited(params.strength, 0, 1)},
          .key = {key(0), key(1), key(2), mean + shaders::edit_recolor::kValueFloor},
          .turn = {std::cos(angle), std::sin(angle) / std::sqrt(3.0f)},
          .size = extent,
          .texture_kept = limited(params.texture, 0, 1),
          .brightness_kept = limited(params.brightness, 0, 1),
          .own_color = params.own_color ? 1.0f : 0.0f,
          .tolerance = limited(params.tolerance, 0, kLargest),
          .value_tolerance = params.value_tolerance >= RecolorParams::kAnyValue
                                 ? kUnlimited
                                 : limited(params.value_tolerance, 0, RecolorParams::kAnyValue),
          .fall_off = 1 / limited(params.softness, kHardestEdge, kLargest),
          .clusters = 0,
          .cluster = 0,
          .first_row = 0};
}

}  // namespace

Recolor::Recolor(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      planes_(device, extent),
      nothing_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      no_bases_(gpu::Buffer::create(device, gpu::Element::vec4, kMaxBases, gpu::Memory::upload)),
      base_color_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      mask_color_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      base_key_(device, {}, device->variant().lone_workgroup),
      mask_key_(device, {}, device->variant().lone_workgroup) {
  std::fill_n(no_bases_->map_as<float>(), 4 * kMaxBases, 0.0f);
  for (uint32_t i = 0; i < by_key_.size(); ++i) {
    const bool matte = i & 1, publish = i >> 1;
    by_key_[i] = {device, {.matte = matte, .publish = publish}};
    by_cluster_[i] = {device, {.matte = matte, .publish = publish}};
    by_base_[i] = {device, {.matte = matte, .publish = publish}};
    by_mask_[i] = {device, {.matte = matte, .publish = publish}};
  }
}

void Recolor::reset() {
  if (palette_) palette_->reset();
  mask_seen_ = false;
}

void Recolor::record(gpu::Commands& commands, Layers& layers, const RecolorParams& params) {
  if (!(params.strength > 0) && !params.write_mask) return;
  const bool by_mask = params.by_mask;
  if (by_mask && !layers[Role::mask]) {  // nothing is selected
    if (!params.write_mask) return;
    const PlanePtr none = planes_.acquire();
    commands.fill(none->buffer);
    return replace(commands, layers, Role::mask, none);
  }
  const bool by_base = !by_mask && params.base >= 0;
  const bool by_cluster = !by_mask && !by_base && params.cluster >= 0;
  const bool matte = by_mask || (params.use_mask && layers[Role::mask]);
  // Decided before anything here refers to the plane a second time.
  const PlanePtr edited = plane_to_edit(layers[Role::intrinsic], planes_);
  // The color of a surface that keeps its own is not known here.
  const bool lights = layers.global() && params.strength > 0 && !params.own_color;
  const PlanePtr mask = params.write_mask || lights ? planes_.acquire() : nullptr;
  const gpu::BufferPtr from = layers[Role::intrinsic]->buffer;
  const size_t variant = (matte ? 1 : 0) + (mask ? 2 : 0);
  Push push = push_of(params, layers.extent);
  const gpu::BufferPtr matte_of = matte ? layers[Role::mask]->buffer : from;
  const gpu::Out published = mask ? gpu::Out(gpu::by_rows(mask->buffer)) : gpu::Out(nothing_);
  const gpu::Rows strips{layers.extent.width, layers.extent.height, kRows};
  if (by_mask) {
    if (!std::exchange(mask_seen_, true)) commands.fill(mask_color_);
    commands.dispatch(mask_key_, {.intrinsic = from, .mask = matte_of, .key = mask_color_},
                      {.size = layers.extent, .rate = kMaskRate}, {});
    commands.dispatch_rows(by_mask_[variant],
                           {.intrinsic = from,
                            .mask = matte_of,
                            .edited = gpu::by_rows(gpu::aliased(edited->buffer)),
                            .published = published,
                            .key = mask_color_},
                           push, strips);
  } else if (by_cluster) {
    const Plane& model = *layers[Role::model];
    if (!palette_) palette_.emplace(device_, layers.extent);
    palette_->record_update(commands, model, params.clusters);
    push.clusters = palette_->palette().params().clusters;
    push.cluster = std::min(params.cluster, kMaxClusters - 1);
    commands.dispatch_rows(by_cluster_[variant],
                           {.intrinsic = from,
                            .mask = matte_of,
                            .edited = gpu::by_rows(gpu::aliased(edited->buffer)),
                            .published = published,
                            .model = model.buffer,
                            .palette = palette_->palette().colors()},
                           push, strips);
  } else if (by_base) {
    const Role role = layers[Role::model_bases] ? Role::model_bases : Role::bases;
    const gpu::BufferPtr& model = layers[Role::model]->buffer;
    const gpu::BufferPtr& bases = layers[role] ? layers[role]->buffer : no_bases_;
    push.cluster = std::min(params.base, static_cast<int>(kMaxBases) - 1);
    commands.dispatch(base_key_, {.key = base_color_, .model = model, .bases = bases},
                      {.size = layers.extent, .index = push.cluster, .fall_off = push.fall_off},
                      {});
    commands.dispatch_rows(by_base_[variant],
                           {.intrinsic = from,
                            .mask = matte_of,
                            .edited = gpu::by_rows(gpu::aliased(edited->buffer)),
                            .published = published,
                            .model = model,
                            .bases = bases,
                            .key = base_color_},
                           push, strips);
  } else {
    commands.dispatch_rows(by_key_[variant],
                           {.intrinsic = from,
                            .mask = matte_of,
                            .edited = gpu::by_rows(gpu::aliased(edited->buffer)),
                            .published = published},
                           push, strips);
  }
  replace(commands, layers, Role::intrinsic, edited);
  if (lights) {
    if (!light_) light_.emplace(device_, layers.extent);
    light_->repaint(commands, layers,
                    {*mask, params.key, by_cluster ? int{push.cluster} : -1, by_base || by_mask,
                     by_cluster ? palette_->palette().colors()
                     : by_mask  ? mask_color_
                                : base_color_},
                    params.target, params.strength);
  }
  if (params.write_mask) replace(commands, layers, Role::mask, mask);
}

}  // namespace inverse
