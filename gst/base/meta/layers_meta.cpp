// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layers_meta.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "gst/base/build_stamp.hpp"
#include "gst/base/log/log.hpp"
#include "kernels/camera/seen_scene.hpp"
#include "kernels/gpu/commands.hpp"
#include "layers_memory.hpp"
#include "registered_once.hpp"

namespace inverse {
namespace {

Layers& layers_in(GstInverseLayersMeta* meta) { return *static_cast<Layers*>(meta->layers); }

// Roles of layers come first; what a frame sees of its scene follows.
static_assert(GST_INVERSE_ROLE_SURFACE == static_cast<int>(Role::count));

/// A plane on the host, which its device is waited for. Throws gpu::Buffer's errors.
gpu::BufferPtr downloaded(const Plane& plane) {
  const auto device = plane.buffer->device();
  auto host = gpu::Buffer::create_by_rows(device, gpu::Element::vec4, plane.extent.pixels(),
                                          gpu::Memory::readback);
  gpu::Commands commands(device);
  commands.begin();
  commands.copy(plane.buffer, host, host->bytes());
  commands.submit();
  commands.wait();
  return host;
}

using Pixels = std::vector<std::array<float, 4>>;

/// GST_INVERSE_ROLE_SURFACE of a frame of this size.
Pixels surface_of(const SeenScene& scene, Extent frame) {
  const gpu::BufferPtr host = downloaded(*scene.surface);
  const auto* view = host->map_as<Pixels::value_type>();
  const auto nearest = [](uint32_t at, uint32_t from, uint32_t to) {
    return (2 * uint64_t{at} + 1) * to / (2 * uint64_t{from});
  };
  Pixels surface;
  surface.reserve(frame.pixels());
  for (uint32_t y = 0; y < frame.height; ++y) {
    const auto* row = view + nearest(y, frame.height, scene.extent.height) * scene.extent.width;
    for (uint32_t x = 0; x < frame.width; ++x)
      surface.push_back(row[nearest(x, frame.width, scene.extent.width)]);
  }
  return surface;
}

/// GST_INVERSE_ROLE_POSE of a frame of this size.
Pixels pose_of(const SeenScene& scene, Extent frame) {
  const gpu::BufferPtr host = downloaded(*scene.pose);
  const auto* rows = host->map_as<Pixels::value_type>();
  const auto& place = rows[1];
  const bool known = rows[2][0] > 0;
  const float across = static_cast<float>(frame.width) / static_cast<float>(scene.extent.width),
              down = static_cast<float>(frame.height) / static_cast<float>(scene.extent.height);
  return {rows[0],
          {place[0], place[1], place[2], known ? 1.0F : 0.0F},
          {scene.lens.fx * across, scene.lens.fy * down, (scene.lens.cx + 0.5F) * across - 0.5F,
           (scene.lens.cy + 0.5F) * down - 0.5F}};
}

GBytes* download(GstInverseLayersMeta* meta, GstInverseRole role) {
  const Layers& layers = layers_in(meta);
  const bool of_scene = role == GST_INVERSE_ROLE_SURFACE || role == GST_INVERSE_ROLE_POSE;
  if (!of_scene && static_cast<size_t>(role) >= static_cast<size_t>(Role::count)) return nullptr;
  try {
    if (of_scene) {
      if (!layers.scene) return nullptr;
      const Pixels pixels = role == GST_INVERSE_ROLE_POSE
                                ? pose_of(*layers.scene, layers.extent)
                                : surface_of(*layers.scene, layers.extent);
      return g_bytes_new(pixels.data(), pixels.size() * sizeof(Pixels::value_type));
    }
    const PlanePtr plane = layers[static_cast<Role>(role)];
    if (!plane) return nullptr;
    const gpu::BufferPtr host = downloaded(*plane);
    return g_bytes_new(host->map(), host->bytes());
  } catch (const std::exception& error) {
    GST_CAT_WARNING(log_of(nullptr).category, "could not read a layer: %s", error.what());
    return nullptr;
  }
}

/// Size of a layer of a frame.
Extent extent_of(Role role, Extent frame) {
  if (role == Role::bases || role == Role::model_bases) return {kMaxBases, 1};
  return role == Role::lamp || role == Role::slope ? Extent{1, 1} : frame;
}

gboolean upload(GstInverseLayersMeta* meta, GstInverseRole role, GBytes* data) {
  if (!gst_buffer_is_writable(meta->buffer)) return FALSE;  // somebody else's frame, too
  Layers& layers = layers_in(meta);
  if (static_cast<size_t>(role) >= static_cast<size_t>(Role::count)) return FALSE;
  const Extent extent = extent_of(static_cast<Role>(role), layers.extent);
  const auto any = std::find_if(layers.planes.begin(), layers.planes.end(),
                                [](const PlanePtr& plane) { return plane != nullptr; });
  if (any == layers.planes.end() || g_bytes_get_size(data) != extent.pixels() * 16) return FALSE;
  try {
    const auto device = (*any)->buffer->device();
    const auto host = gpu::Buffer::create_by_rows(device, gpu::Element::vec4, extent.pixels(),
                                                  gpu::Memory::upload);
    memcpy(host->map(), g_bytes_get_data(data, nullptr), host->bytes());
    const auto plane = std::make_shared<Plane>(
        Plane{extent, gpu::Buffer::create_by_rows(device, gpu::Element::vec4, extent.pixels())});
    gpu::Commands commands(device);
    commands.begin();
    commands.copy(host, plane->buffer, host->bytes());
    commands.submit();
    commands.wait();
    layers[static_cast<Role>(role)] = plane;
    return TRUE;
  } catch (const std::exception& error) {
    GST_CAT_WARNING(log_of(nullptr).category, "could not write a layer: %s", error.what());
    return FALSE;
  }
}

gboolean init(GstMeta* meta, gpointer, GstBuffer* buffer) {
  auto* self = reinterpret_cast<GstInverseLayersMeta*>(meta);
  self->width = self->height = 0;
  self->download = download;
  self->upload = upload;
  self->version = GST_INVERSE_LAYERS_META_VERSION;
  self->layers = new Layers;
  self->buffer = buffer;
  return TRUE;
}

void release(GstMeta* meta, GstBuffer*) {
  delete &layers_in(reinterpret_cast<GstInverseLayersMeta*>(meta));
}

gboolean transform(GstBuffer* target, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) {
  // Copies share the planes; a region of a buffer has no layers of its own.
  if (!GST_META_TRANSFORM_IS_COPY(type) || static_cast<GstMetaTransformCopy*>(data)->region)
    return FALSE;
  attach_layers(target, layers_in(reinterpret_cast<GstInverseLayersMeta*>(meta)));
  return TRUE;
}

GType meta_api() {
  static const gchar* tags[] = {GST_META_TAG_MEMORY_STR, nullptr};
  static const GType type = type_registered_once(GST_INVERSE_LAYERS_META_API_NAME, [] {
    return gst_meta_api_type_register(GST_INVERSE_LAYERS_META_API_NAME, tags);
  });
  return type;
}

const GstMetaInfo* meta_info() {
  constexpr const char* kName = "GstInverseLayersMeta-" BUILD_STAMP;
  static const GstMetaInfo* info = meta_registered_once(kName, [] {
    return gst_meta_register(meta_api(), kName, sizeof(GstInverseLayersMeta), init, release,
                             transform);
  });
  return info;
}

}  // namespace

void register_layers_meta() { meta_info(); }

void attach_layers(GstBuffer* buffer, const Layers& layers) {
  auto* meta =
      reinterpret_cast<GstInverseLayersMeta*>(gst_buffer_add_meta(buffer, meta_info(), nullptr));
  meta->width = layers.extent.width;
  meta->height = layers.extent.height;
  layers_in(meta) = layers;
  if (gst_buffer_n_memory(buffer) == 0)
    gst_buffer_append_memory(buffer, new_layers_memory(layers.bytes()));
}

const Layers* layers_of(GstBuffer* buffer) {
  auto* meta = reinterpret_cast<GstInverseLayersMeta*>(gst_buffer_get_meta(buffer, meta_api()));
  // Another build has its own layout of Layers.
  return meta && meta->meta.info == meta_info() ? &layers_in(meta) : nullptr;
}

Layers take_layers(GstBuffer* buffer) {
  auto* meta = reinterpret_cast<GstInverseLayersMeta*>(gst_buffer_get_meta(buffer, meta_api()));
  return gst_buffer_is_writable(buffer) ? std::move(layers_in(meta)) : layers_in(meta);
}

}  // namespace inverse
