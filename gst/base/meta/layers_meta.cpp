// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layers_meta.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "gst/base/log/log.hpp"
#include "kernels/gpu/commands.hpp"
#include "layers_memory.hpp"
#include "registered_once.hpp"

namespace inverse {
namespace {

Layers& layers_in(GstInverseLayersMeta* meta) { return *static_cast<Layers*>(meta->layers); }

GBytes* download(GstInverseLayersMeta* meta, GstInverseRole role) {
  if (static_cast<size_t>(role) >= static_cast<size_t>(Role::count)) return nullptr;
  const PlanePtr plane = layers_in(meta)[static_cast<Role>(role)];
  if (!plane) return nullptr;
  try {
    const auto device = plane->buffer->device();
    const auto host = gpu::Buffer::create_by_rows(device, gpu::Element::vec4,
                                                  plane->extent.pixels(), gpu::Memory::readback);
    gpu::Commands commands(device);
    commands.begin();
    commands.copy(plane->buffer, host, host->bytes());
    commands.submit();
    commands.wait();
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
  constexpr const char* kName = "GstInverseLayersMeta";
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
  return meta ? &layers_in(meta) : nullptr;
}

Layers take_layers(GstBuffer* buffer) {
  auto* meta = reinterpret_cast<GstInverseLayersMeta*>(gst_buffer_get_meta(buffer, meta_api()));
  return gst_buffer_is_writable(buffer) ? std::move(layers_in(meta)) : layers_in(meta);
}

}  // namespace inverse
