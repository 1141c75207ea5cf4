// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sent_picture.hpp"

namespace inverse {
namespace {

constexpr const char* kName = "GstInverseSentPicture";

bool same_params(const SplitParams& a, const SplitParams& b) {
  return a.encoding == b.encoding && a.reflectance_scale == b.reflectance_scale &&
         a.shading_scale == b.shading_scale;
}

}  // namespace

bool same_pictures(const GstVideoInfo& a, const GstVideoInfo& b) {
  return GST_VIDEO_INFO_FORMAT(&a) == GST_VIDEO_INFO_FORMAT(&b) &&
         GST_VIDEO_INFO_WIDTH(&a) == GST_VIDEO_INFO_WIDTH(&b) &&
         GST_VIDEO_INFO_HEIGHT(&a) == GST_VIDEO_INFO_HEIGHT(&b) && a.chroma_site == b.chroma_site &&
         gst_video_colorimetry_is_equal(&a.colorimetry, &b.colorimetry);
}

bool SentPicture::operator==(const SentPicture& other) const {
  return layer == other.layer && edited == other.edited && primaries == other.primaries &&
         same_pictures(info, other.info) && same_params(params, other.params);
}

float SentPicture::gain() const {
  return layer == SplitLayer::reflectance ? params.reflectance_scale
         : layer == SplitLayer::mask      ? 1
                                          : params.shading_scale;
}

GstEvent* SentPicture::event() const {
  GstCaps* caps = gst_video_info_to_caps(&info);
  GstStructure* structure = gst_structure_new(
      kName, "layer", G_TYPE_INT, static_cast<int>(layer), "caps", GST_TYPE_CAPS, caps, "primaries",
      G_TYPE_INT, static_cast<int>(primaries), "linear", G_TYPE_BOOLEAN, linear(),
      "reflectance-scale", G_TYPE_FLOAT, params.reflectance_scale, "shading-scale", G_TYPE_FLOAT,
      params.shading_scale, "edited", G_TYPE_BOOLEAN, edited, nullptr);
  gst_caps_unref(caps);
  return gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM_STICKY, structure);
}

std::optional<SentPicture> SentPicture::of(GstEvent* event) {
  const GstStructure* structure = gst_event_get_structure(event);
  if (!structure || !gst_structure_has_name(structure, kName)) return {};
  SentPicture sent;
  int layer = 0, primaries = 0;
  gboolean linear = FALSE, edited = FALSE;
  GstCaps* caps = nullptr;
  if (!gst_structure_get(structure, "layer", G_TYPE_INT, &layer, "caps", GST_TYPE_CAPS, &caps,
                         "primaries", G_TYPE_INT, &primaries, "linear", G_TYPE_BOOLEAN, &linear,
                         "reflectance-scale", G_TYPE_FLOAT, &sent.params.reflectance_scale,
                         "shading-scale", G_TYPE_FLOAT, &sent.params.shading_scale, "edited",
                         G_TYPE_BOOLEAN, &edited, nullptr))
    return {};
  const bool known = gst_video_info_from_caps(&sent.info, caps);
  gst_caps_unref(caps);
  if (!known || layer < 0 || layer >= static_cast<int>(SplitLayer::count)) return {};
  sent.layer = static_cast<SplitLayer>(layer);
  sent.primaries = static_cast<GstVideoColorPrimaries>(primaries);
  sent.params.encoding = linear ? SplitParams::Encoding::linear : SplitParams::Encoding::srgb;
  sent.edited = edited;
  return sent;
}

}  // namespace inverse
