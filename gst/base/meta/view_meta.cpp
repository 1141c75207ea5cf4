// SPDX-License-Identifier: LGPL-2.1-or-later
#include "view_meta.hpp"

#include "registered_once.hpp"

namespace inverse {
namespace {

constexpr const char* kName = "GstInverseViewMeta";
constexpr const char *kElement = "element", *kLayer = "layer", *kFrame = "frame";

const GstMetaInfo* meta_info() {
  static const GstMetaInfo* info = meta_registered_once(kName, [] {
    // Without tags: it holds whatever becomes of colors, size and memory.
    const gchar* tags[] = {nullptr};
    return gst_meta_register_custom(kName, tags, nullptr, nullptr, nullptr);
  });
  return info;
}

GstMeta* find(GstBuffer* buffer) { return gst_buffer_get_meta(buffer, meta_info()->api); }

}  // namespace

void mark_view(GstBuffer* buffer, const ViewMark& mark) {
  if (GstMeta* old = find(buffer)) gst_buffer_remove_meta(buffer, old);
  GstCustomMeta* meta = gst_buffer_add_custom_meta(buffer, kName);
  gst_structure_set(gst_custom_meta_get_structure(meta), kElement, G_TYPE_STRING,
                    mark.element.c_str(), kLayer, G_TYPE_STRING, mark.layer.c_str(), kFrame,
                    G_TYPE_STRING, mark.frame.c_str(), nullptr);
}

std::optional<ViewMark> view_mark(GstBuffer* buffer) {
  auto* meta = reinterpret_cast<GstCustomMeta*>(find(buffer));
  if (!meta) return {};
  GstStructure* fields = gst_custom_meta_get_structure(meta);
  const auto text = [&](const char* name) {
    const gchar* value = gst_structure_get_string(fields, name);
    return std::string(value ? value : "");
  };
  return ViewMark{text(kElement), text(kLayer), text(kFrame)};
}

}  // namespace inverse
