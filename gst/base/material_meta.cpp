#include "material_meta.hpp"

#include <gst/video/video.h>

#include <cstddef>
#include <cstring>

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

gboolean transform(GstBuffer* target, GstMeta* meta, GstBuffer*, GQuark type, gpointer) {
  // A box in pixels says nothing of a buffer of another size.
  if (!GST_META_TRANSFORM_IS_COPY(type)) return FALSE;
  GstMaterialMeta* copy = add_material_meta(target);
  memcpy(reinterpret_cast<char*>(copy) + kFields, reinterpret_cast<char*>(meta) + kFields,
         sizeof(GstMaterialMeta) - kFields);
  if (copy->environment) g_bytes_ref(copy->environment);
  return TRUE;
}

const GstMetaInfo* meta_info() {
  static const gchar* tags[] = {GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR, nullptr};
  static const GstMetaInfo* info =
      gst_meta_register(gst_meta_api_type_register(GST_MATERIAL_META_API_NAME, tags),
                        "GstMaterialMeta", sizeof(GstMaterialMeta), init, release, transform);
  return info;
}

}  // namespace

void register_material_meta() { meta_info(); }

GstMaterialMeta* add_material_meta(GstBuffer* buffer) {
  return reinterpret_cast<GstMaterialMeta*>(gst_buffer_add_meta(buffer, meta_info(), nullptr));
}

}  // namespace inverse
