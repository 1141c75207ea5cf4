// SPDX-License-Identifier: LGPL-2.1-or-later
#include "material_meta.hpp"

#include <gst/video/video.h>

#include <cstddef>
#include <cstring>

#include "gst/base/meta/registered_once.hpp"

namespace inverse {
namespace {

constexpr size_t kFields = offsetof(GstMaterialMeta, found);  // what follows GstMeta

gboolean init(GstMeta* meta, gpointer, GstBuffer*) {
  memset(reinterpret_cast<char*>(meta) + kFields, 0, sizeof(GstMaterialMeta) - kFields);
  return TRUE;
}

void release(GstMeta* meta, GstBuffer*) {
  GBytes* environment = reinterpret_cast<GstMaterialMeta*>(meta)->environment;
  if (environment) g_bytes_unref(environment);
}

gboolean transform(GstBuffer* target, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) {
  const bool scaled = GST_VIDEO_META_TRANSFORM_IS_SCALE(type);
  if (!scaled && !GST_META_TRANSFORM_IS_COPY(type)) return FALSE;
  GstMaterialMeta* copy = add_material_meta(target);
  memcpy(reinterpret_cast<char*>(copy) + kFields, reinterpret_cast<char*>(meta) + kFields,
         sizeof(GstMaterialMeta) - kFields);
  if (copy->environment) g_bytes_ref(copy->environment);
  if (scaled) {
    const auto* sizes = static_cast<const GstVideoMetaTransform*>(data);
    const float across = static_cast<float>(GST_VIDEO_INFO_WIDTH(sizes->out_info)) /
                         static_cast<float>(GST_VIDEO_INFO_WIDTH(sizes->in_info));
    const float down = static_cast<float>(GST_VIDEO_INFO_HEIGHT(sizes->out_info)) /
                       static_cast<float>(GST_VIDEO_INFO_HEIGHT(sizes->in_info));
    copy->left *= across;
    copy->right *= across;
    copy->top *= down;
    copy->bottom *= down;
  }
  return TRUE;
}

const GstMetaInfo* meta_info() {
  // As of regions of interest: who converts or scales frames asks us, who crops or turns them, so
  // that box and light would be wrong, drops the meta.
  static const gchar* tags[] = {GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_ORIENTATION_STR,
                                GST_META_TAG_VIDEO_SIZE_STR, nullptr};
  constexpr const char* kName = "GstMaterialMeta";
  static const GstMetaInfo* info = meta_registered_once(kName, [] {
    return gst_meta_register(gst_meta_api_type_register(GST_MATERIAL_META_API_NAME, tags), kName,
                             sizeof(GstMaterialMeta), init, release, transform);
  });
  return info;
}

}  // namespace

void register_material_meta() { meta_info(); }

GstMaterialMeta* add_material_meta(GstBuffer* buffer) {
  return reinterpret_cast<GstMaterialMeta*>(gst_buffer_add_meta(buffer, meta_info(), nullptr));
}

}  // namespace inverse
