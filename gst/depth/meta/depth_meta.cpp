// SPDX-License-Identifier: LGPL-2.1-or-later
#include "depth_meta.hpp"

#include <gst/video/video.h>

#include <cstddef>
#include <cstring>

#include "gst/base/meta/registered_once.hpp"

namespace inverse {
namespace {

constexpr size_t kFields = offsetof(GstInverseDepthMeta, depth);  // what follows GstMeta

gboolean init(GstMeta* meta, gpointer, GstBuffer*) {
  memset(reinterpret_cast<char*>(meta) + kFields, 0, sizeof(GstInverseDepthMeta) - kFields);
  return TRUE;
}

void release(GstMeta* meta, GstBuffer*) {
  gst_clear_buffer(&reinterpret_cast<GstInverseDepthMeta*>(meta)->depth);
}

gboolean transform(GstBuffer* target, GstMeta* meta, GstBuffer*, GQuark type, gpointer) {
  // The image has a size of its own, so it suits the picture in any size.
  if (!GST_VIDEO_META_TRANSFORM_IS_SCALE(type) && !GST_META_TRANSFORM_IS_COPY(type)) return FALSE;
  GstInverseDepthMeta* copy = add_depth_meta(target);
  memcpy(reinterpret_cast<char*>(copy) + kFields, reinterpret_cast<char*>(meta) + kFields,
         sizeof(GstInverseDepthMeta) - kFields);
  if (copy->depth) gst_buffer_ref(copy->depth);
  return TRUE;
}

const GstMetaInfo* meta_info() {
  constexpr const char* kName = "GstInverseDepthMeta";
  // Who converts or scales frames asks us; who crops or turns them drops the meta.
  static const gchar* tags[] = {GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_ORIENTATION_STR,
                                GST_META_TAG_VIDEO_SIZE_STR, nullptr};
  static const GstMetaInfo* info = meta_registered_once(kName, [] {
    return gst_meta_register(gst_meta_api_type_register(GST_INVERSE_DEPTH_META_API_NAME, tags),
                             kName, sizeof(GstInverseDepthMeta), init, release, transform);
  });
  return info;
}

}  // namespace

void register_depth_meta() { meta_info(); }

GstInverseDepthMeta* add_depth_meta(GstBuffer* buffer) {
  return reinterpret_cast<GstInverseDepthMeta*>(gst_buffer_add_meta(buffer, meta_info(), nullptr));
}

GstInverseDepthMeta* add_depth_meta(GstBuffer* buffer, GstBuffer* image, double unit,
                                    const CalibratedCamera& lens) {
  GstInverseDepthMeta* meta = add_depth_meta(buffer);
  meta->depth = image;
  meta->width = lens.size.width;
  meta->height = lens.size.height;
  meta->stride = 2 * lens.size.width;
  meta->unit = unit;
  meta->fx = lens.fx;
  meta->fy = lens.fy;
  meta->cx = lens.cx;
  meta->cy = lens.cy;
  return meta;
}

}  // namespace inverse
