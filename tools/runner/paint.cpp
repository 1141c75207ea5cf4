// SPDX-License-Identifier: LGPL-2.1-or-later
#include "paint.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace inverse::run {
namespace {

constexpr int kWidth = 240;
constexpr size_t kMoments = 12;
constexpr GstClockTime kSpacing = GST_SECOND / 4;
constexpr GstClockTime kTimeout = 20 * GST_SECOND;  // for a file that decodes slowly

using Color = std::array<double, 3>;

struct Hue {
  const char* name;
  Color chromaticity;  // mean 1
};
// Target colors of the key, and their names.
constexpr Hue kTargets[] = {
    {"blue", {0.06, 0.52, 2.42}}, {"orange", {2.61, 0.30, 0.09}}, {"green", {0.20, 2.40, 0.40}}};
constexpr Hue kNames[] = {
    {"red", {2.6, 0.2, 0.2}},   {"orange", {2.2, 0.6, 0.2}}, {"yellow", {1.5, 1.3, 0.2}},
    {"green", {0.4, 2.2, 0.4}}, {"cyan", {0.15, 1.5, 1.35}}, {"light blue", {0.2, 0.9, 1.9}},
    {"blue", {0.1, 0.4, 2.5}},  {"purple", {1.2, 0.2, 1.6}}, {"pink", {1.7, 0.2, 1.1}}};
constexpr guint kPaint = 0xffe0c0a0;  // if no color stands out

double distance(const Color& a, const Color& b) {
  double sum = 0;
  for (size_t k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(sum);
}

/// The hue of a color, independent of its saturation.
const char* name_of(const Color& chromaticity) {
  const auto direction = [](const Color& c) {
    const double length = std::max(distance(c, {1, 1, 1}), 1e-6);
    return Color{(c[0] - 1) / length, (c[1] - 1) / length, (c[2] - 1) / length};
  };
  const Color own = direction(chromaticity);
  return std::min_element(std::begin(kNames), std::end(kNames),
                          [&](const Hue& a, const Hue& b) {
                            return distance(direction(a.chromaticity), own) <
                                   distance(direction(b.chromaticity), own);
                          })
      ->name;
}

/// 0xAARRGGBB of a linear color, sRGB.
guint packed(const Color& linear) {
  guint value = 0xff;
  for (const double light : linear)
    value = value << 8 |
            static_cast<guint>(std::clamp(
                std::lround(255 * gst_video_transfer_function_encode(GST_VIDEO_TRANSFER_SRGB,
                                                                     std::clamp(light, 0.0, 1.0))),
                0l, 255l));
  return value;
}

}  // namespace

Paint::Paint(GstElement* recolor)
    : recolor_(GST_ELEMENT(gst_object_ref(recolor))), maker_(kWidth) {}

Paint::~Paint() { gst_object_unref(recolor_); }

void Paint::choose_for(const std::string& uri) {
  GstElement* line = gst_parse_launch(
      "uridecodebin name=file expose-all-streams=false caps=video/x-raw(ANY) ! fakesink name=end "
      "sync=false",
      nullptr);
  if (!line) return;
  GstElement* file = gst_bin_get_by_name(GST_BIN(line), "file");
  g_object_set(file, "uri", uri.c_str(), nullptr);
  gst_object_unref(file);
  GstElement* end = gst_bin_get_by_name(GST_BIN(line), "end");
  GstPad* pad = gst_element_get_static_pad(end, "sink");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      +[](GstPad* from, GstPadProbeInfo* info, gpointer data) {
        auto* self = static_cast<Paint*>(data);
        GstCaps* caps = gst_pad_get_current_caps(from);
        self->offer(GST_PAD_PROBE_INFO_BUFFER(info), caps);
        if (caps) gst_caps_unref(caps);
        if (!self->chosen_) return GST_PAD_PROBE_OK;
        GST_PAD_PROBE_INFO_FLOW_RETURN(info) = GST_FLOW_EOS;
        gst_buffer_unref(GST_PAD_PROBE_INFO_BUFFER(info));
        return GST_PAD_PROBE_HANDLED;
      },
      this, nullptr);
  gst_object_unref(pad);
  gst_object_unref(end);
  gst_element_set_state(line, GST_STATE_PLAYING);
  GstBus* bus = gst_element_get_bus(line);
  GstMessage* message = gst_bus_timed_pop_filtered(
      bus, kTimeout, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  if (message) gst_message_unref(message);
  gst_object_unref(bus);
  gst_element_set_state(line, GST_STATE_NULL);
  gst_object_unref(line);
  if (!chosen_ && !moments_.empty()) choose();  // a short file
}

void Paint::offer(GstBuffer* buffer, const GstCaps* caps) {
  if (chosen_) return;
  const GstClockTime time = GST_BUFFER_PTS(buffer);
  if (GST_CLOCK_TIME_IS_VALID(time)) {
    if (time < next_ && !moments_.empty()) return;
    next_ = time + kSpacing;
  }
  const SmallPicture picture = maker_.make(buffer, caps);
  if (picture.rgb.empty()) return;
  const GstVideoTransferFunction transfer = maker_.colorimetry().transfer;
  std::array<float, 256> linear;
  for (size_t i = 0; i < linear.size(); ++i)
    linear[i] = static_cast<float>(gst_video_transfer_function_decode(
        transfer == GST_VIDEO_TRANSFER_UNKNOWN ? GST_VIDEO_TRANSFER_SRGB : transfer,
        static_cast<double>(i) / 255));
  LinearPicture moment{picture.width, picture.height, {}};
  for (const uint8_t code : picture.rgb) moment.rgb.push_back(linear[code]);
  moments_.push_back(std::move(moment));
  if (moments_.size() == kMoments) choose();
}

void Paint::choose() {
  const auto key = find_key_color(moments_);
  moments_.clear();
  if (key) {
    const Hue& target = *std::max_element(std::begin(kTargets), std::end(kTargets),
                                          [&](const Hue& a, const Hue& b) {
                                            return distance(a.chromaticity, key->chromaticity) <
                                                   distance(b.chromaticity, key->chromaticity);
                                          });
    // Both have the same mean, so that brightness stays; as bright as can be encoded.
    double largest = 0;
    for (size_t k = 0; k < 3; ++k)
      largest = std::max({largest, key->chromaticity[k], target.chromaticity[k]});
    Color from = key->chromaticity, to = target.chromaticity;
    for (size_t k = 0; k < 3; ++k) from[k] /= largest, to[k] /= largest;
    g_object_set(recolor_, "key", packed(from), "target", packed(to), "tolerance", key->tolerance,
                 "softness", key->softness, "strength", 1.0, nullptr);
    fprintf(stderr, "painting what is %s (%.0f %% of the picture, #%06x) in %s\n",
            name_of(key->chromaticity), std::max(1.0, 100 * key->share), packed(from) & 0xffffff,
            target.name);
  } else {
    constexpr guint kAnyKey = 0xff808080;  // within the tolerance of every color
    g_object_set(recolor_, "key", kAnyKey, "target", kPaint, "tolerance", 4.25, "texture", 0.0,
                 "strength", 1.0, nullptr);
    fprintf(stderr,
            "no color stands out in the first seconds: painting every surface in one color\n");
  }
  chosen_ = true;
}

}  // namespace inverse::run
