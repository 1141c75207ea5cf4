// SPDX-License-Identifier: LGPL-2.1-or-later
#include "caps.hpp"

#include <gst/video/video.h>

#include <span>
#include <string>
#include <vector>

#include "gst/base/frames/video_format.hpp"
#include "gst/base/vulkan/vulkan_bridge.hpp"
#include "gst/inverse/inverse_layers_meta.h"

namespace inverse {
namespace {

constexpr const char* kGeometry =
    "width = (int) [ 1, 32767 ], height = (int) [ 1, 32767 ], framerate = (fraction) [ 0, max ]";

std::string names_of(std::span<const GstVideoFormat> formats) {
  std::string names;
  for (const GstVideoFormat format : formats)
    names += (names.empty() ? "" : ", ") + std::string(gst_video_format_to_string(format));
  return names;
}

bool have_same_frames(const GstCaps* a, const GstCaps* b) {
  GstCaps* both[] = {gst_caps_copy(a), gst_caps_copy(b)};
  for (GstCaps* caps : both)
    for (guint i = 0; i < gst_caps_get_size(caps); ++i)
      gst_structure_remove_fields(gst_caps_get_structure(caps, i), "framerate", "max-framerate",
                                  "pixel-aspect-ratio", nullptr);
  const bool same = gst_caps_is_equal(both[0], both[1]);
  for (GstCaps* caps : both) gst_caps_unref(caps);
  return same;
}

GstCaps* layer_caps(const char* layers) {
  const std::string text = std::string("video/x-raw(" GST_CAPS_FEATURE_META_INVERSE_LAYERS
                                       "), format = (string) RGBA, layers = (string) ") +
                           layers + ", " + kGeometry;
  return gst_caps_from_string(text.c_str());
}

/// Formats beyond these two make GStreamer's Vulkan library abort or shear the picture (1.22).
GstCaps* image_caps() {
  const std::string text = std::string("video/x-raw(") + kVulkanImageFeature +
                           "), format = (string) { RGBA, BGRA }, " + kGeometry;
  return gst_caps_from_string(text.c_str());
}

/// The caps with images behind all else: who does not insist gets pixels that anybody can read.
GstCaps* with_images(GstCaps* caps) {
  if (has_vulkan_images()) gst_caps_append(caps, image_caps());
  return caps;
}

/// Those structures of `caps` that have the features of the first.
GstCaps* like_first(const GstCaps* caps) {
  GstCaps* alike = gst_caps_new_empty();
  if (gst_caps_is_empty(caps)) return alike;
  const GstCapsFeatures* first = gst_caps_get_features(caps, 0);
  for (guint i = 0; i < gst_caps_get_size(caps); ++i)
    if (gst_caps_features_is_equal(gst_caps_get_features(caps, i), first))
      gst_caps_append(alike, gst_caps_copy_nth(caps, i));
  return alike;
}

/// Those of `other`, all in the same memory, that have the format and, where possible, all else of
/// `caps`; null if none has, or if the other side prefers layers.
GstCaps* keep_format(GstCaps* caps, GstCaps* other) {
  if (gst_caps_is_empty(other) || carries_layers(other)) return nullptr;
  const GstCapsFeatures* features = gst_caps_get_features(other, 0);
  GstCaps* like = gst_caps_copy(caps);
  gst_caps_set_features_simple(like, gst_caps_features_copy(features));
  GstCaps* same = gst_caps_intersect_full(other, like, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(like);
  if (!gst_caps_is_empty(same)) return same;
  gst_caps_unref(same);
  const GValue* format = gst_structure_get_value(gst_caps_get_structure(caps, 0), "format");
  if (!format) return nullptr;
  GstCaps* wanted = gst_caps_new_empty_simple("video/x-raw");
  gst_caps_set_value(wanted, "format", format);
  gst_caps_set_features_simple(wanted, gst_caps_features_copy(features));
  same = gst_caps_intersect_full(other, wanted, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(wanted);
  if (!gst_caps_is_empty(same)) return same;
  gst_caps_unref(same);
  return nullptr;
}

bool is_hdr(const GstVideoColorimetry& color) {
  return color.transfer == GST_VIDEO_TRANSFER_SMPTE2084 ||
         color.transfer == GST_VIDEO_TRANSFER_ARIB_STD_B67;
}

/// The format whose content a picture of these caps has: layers are floats, of which ordinary range
/// needs eight bits.
GstVideoFormat content_of(const GstVideoInfo& info, bool layers) {
  return layers && is_hdr(info.colorimetry) ? GST_VIDEO_FORMAT_RGBA64_LE
                                            : GST_VIDEO_INFO_FORMAT(&info);
}

/// Those of `other`, all in the same memory, that have the nearest of its formats; null if the
/// input has eight bits.
GstCaps* keep_depth(GstCaps* caps, GstCaps* other) {
  GstVideoInfo info;
  if (gst_caps_is_empty(other) || carries_layers(other) || !gst_video_info_from_caps(&info, caps))
    return nullptr;
  const GstVideoFormat content = content_of(info, carries_layers(caps));
  const GValue* list = gst_structure_get_value(gst_caps_get_structure(other, 0), "format");
  if (GST_VIDEO_FORMAT_INFO_DEPTH(gst_video_format_get_info(content), 0) <= 8 || !list ||
      !GST_VALUE_HOLDS_LIST(list))
    return nullptr;
  std::vector<GstVideoFormat> formats;
  for (guint i = 0; i < gst_value_list_get_size(list); ++i)
    formats.push_back(
        gst_video_format_from_string(g_value_get_string(gst_value_list_get_value(list, i))));
  GstCaps* result = gst_caps_copy_nth(other, 0);
  gst_caps_set_simple(result, "format", G_TYPE_STRING,
                      gst_video_format_to_string(nearest_format(content, formats)), nullptr);
  return result;
}

/// Where the output's color is left open, labels it with the input's: code values then mean the
/// same on both sides, as users of videoconvert expect, and the label stays true. Range and matrix
/// carry over only among Y'CbCr or RGB.
void keep_colorimetry(GstCaps* in, GstCaps* out) {
  GstVideoInfo from, to;
  if (!gst_caps_is_fixed(out) ||
      gst_structure_has_field(gst_caps_get_structure(out, 0), "colorimetry"))
    return;
  if (!gst_video_info_from_caps(&from, in) || !gst_video_info_from_caps(&to, out)) return;
  GstVideoColorimetry color = to.colorimetry;
  color.transfer = from.colorimetry.transfer;
  color.primaries = from.colorimetry.primaries;
  if (GST_VIDEO_INFO_IS_YUV(&to)) {
    if (GST_VIDEO_INFO_IS_YUV(&from)) color = from.colorimetry;
    // BT.2020 has one matrix for all sizes.
    else if (color.primaries == GST_VIDEO_COLOR_PRIMARIES_BT2020)
      color.matrix = GST_VIDEO_COLOR_MATRIX_BT2020;
  }
  if (gst_video_colorimetry_is_equal(&color, &to.colorimetry)) return;
  gchar* text = gst_video_colorimetry_to_string(&color);
  gst_caps_set_simple(out, "colorimetry", G_TYPE_STRING, text, nullptr);
  g_free(text);
}

}  // namespace

GstCaps* pixel_caps(Prefer prefer) {
  const bool gray = prefer == Prefer::gray;
  const std::string formats = names_of(gray ? gray_formats() : color_formats()) + ", " +
                              names_of(gray ? color_formats() : gray_formats());
  const std::string text = "video/x-raw, format = (string) { " + formats + " }, " + kGeometry;
  return gst_caps_from_string(text.c_str());
}

GstCaps* template_caps(Flow flow, const char* layers) {
  switch (flow) {
    case Flow::pixels:
      return with_images(pixel_caps());
    case Flow::layers:
      return layer_caps(layers);
    case Flow::pixels_or_layers: {
      GstCaps* caps = pixel_caps();
      gst_caps_append(caps, layer_caps(layers));
      return with_images(caps);
    }
    case Flow::layers_or_pixels: {
      GstCaps* caps = layer_caps(layers);
      gst_caps_append(caps, pixel_caps());
      return with_images(caps);
    }
  }
  return nullptr;
}

bool carries_layers(const GstCaps* caps) {
  return gst_caps_get_size(caps) > 0 &&
         gst_caps_features_contains(gst_caps_get_features(caps, 0),
                                    GST_CAPS_FEATURE_META_INVERSE_LAYERS);
}

bool carries_images(const GstCaps* caps) {
  return gst_caps_get_size(caps) > 0 &&
         gst_caps_features_contains(gst_caps_get_features(caps, 0), kVulkanImageFeature);
}

std::string kind_of(const GstCaps* caps) {
  const gchar* kind = carries_layers(caps)
                          ? gst_structure_get_string(gst_caps_get_structure(caps, 0), "layers")
                          : nullptr;
  return kind ? kind : "";
}

bool carries_kind(const GstCaps* caps, const char* layers) { return kind_of(caps) == layers; }

GstCaps* transform_caps(GstCaps* caps, GstCaps* templates, GstCaps* filter) {
  GstCaps* result = gst_caps_new_empty();
  for (guint t = 0; t < gst_caps_get_size(templates); ++t) {
    for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
      // What describes the picture's shape in space and time carries over; how it is coded does
      // not.
      GstStructure* structure = gst_structure_copy(gst_caps_get_structure(caps, i));
      for (const char* field : {"format", "colorimetry", "chroma-site"})
        gst_structure_remove_field(structure, field);
      const GstCapsFeatures* to = gst_caps_get_features(templates, t);
      if (!gst_caps_features_is_equal(gst_caps_get_features(caps, i), to))
        gst_structure_remove_field(structure, "layers");
      GstCaps* wide = gst_caps_new_full(structure, nullptr);
      gst_caps_set_features(wide, 0, gst_caps_features_copy(to));
      GstCaps* one = gst_caps_copy_nth(templates, t);
      // Merged in order: simplifying would sort, and the first is what others prefer.
      result = gst_caps_merge(result, gst_caps_intersect_full(wide, one, GST_CAPS_INTERSECT_FIRST));
      gst_caps_unref(wide);
      gst_caps_unref(one);
    }
  }
  gst_caps_unref(templates);
  return filter_caps(result, filter);
}

GstCaps* same_content(GstPadDirection, GstCaps* caps, GstCaps* templates, GstCaps* filter) {
  GstCaps* result = gst_caps_new_empty();
  for (guint i = 0; i < gst_caps_get_size(caps); ++i) {
    GstCaps* one = gst_caps_copy_nth(caps, i);
    const bool layers = carries_layers(one);
    GstCaps* alike = gst_caps_new_empty();
    for (guint t = 0; t < gst_caps_get_size(templates); ++t) {
      GstCaps* other = gst_caps_copy_nth(templates, t);
      if (carries_layers(other) == layers)
        gst_caps_append(alike, other);
      else
        gst_caps_unref(other);
    }
    result = gst_caps_merge(result, transform_caps(one, alike, nullptr));
    gst_caps_unref(one);
  }
  gst_caps_unref(templates);
  return filter_caps(result, filter);
}

GstCaps* filter_caps(GstCaps* caps, GstCaps* filter) {
  if (!filter) return caps;
  GstCaps* filtered = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(caps);
  return filtered;
}

GstCaps* prefer_layers(const GstCaps* caps) {
  GstCaps* result = gst_caps_new_empty();
  for (const bool layers : {true, false})
    for (guint i = 0; i < gst_caps_get_size(caps); ++i)
      if (gst_caps_features_contains(gst_caps_get_features(caps, i),
                                     GST_CAPS_FEATURE_META_INVERSE_LAYERS) == layers)
        gst_caps_append(result, gst_caps_copy_nth(caps, i));
  return result;
}

void drop_hdr_metadata(GstCaps* caps) {
  GstVideoInfo info;
  if (!gst_caps_is_fixed(caps) || !gst_video_info_from_caps(&info, caps) ||
      is_hdr(info.colorimetry))
    return;
  gst_structure_remove_fields(gst_caps_get_structure(caps, 0), "mastering-display-info",
                              "content-light-level", nullptr);
}

GstCaps* fixate_caps(GstCaps* caps, GstCaps* other) {
  GstCaps* alike = like_first(other);
  gst_caps_unref(other);
  other = alike;
  GstCaps* result = carries_layers(caps) ? nullptr : keep_format(caps, other);
  if (!result) result = keep_depth(caps, other);
  result =
      result ? gst_caps_fixate(result) : gst_caps_fixate(gst_caps_truncate(gst_caps_ref(other)));
  gst_caps_unref(other);
  keep_colorimetry(caps, result);
  drop_hdr_metadata(result);
  return result;
}

void CapsPair::set(GstCaps* in, GstCaps* out) {
  gst_caps_replace(&in_, in);
  gst_caps_replace(&out_, out);
}

bool CapsPair::is(const GstCaps* in, const GstCaps* out) const {
  return in_ && out_ && gst_caps_is_equal(in_, in) && gst_caps_is_equal(out_, out);
}

bool CapsPair::same_frames(const GstCaps* in, const GstCaps* out) const {
  return in_ && out_ && have_same_frames(in_, in) && have_same_frames(out_, out);
}

}  // namespace inverse
