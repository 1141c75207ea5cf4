// Numbers of base colors over the bundled clip, in which a lamp and a ball move.
#include <gst/gst.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace {

constexpr size_t kSlots = 16;
using Frame = std::array<std::optional<std::array<double, 2>>, kSlots>;

/// Log chroma of 0xAARRGGBB.
std::array<double, 2> chroma_of(guint color) {
  const auto log_of = [&](int shift) {
    const double code = (color >> shift & 0xff) / 255.0;
    return std::log((code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4)) +
                    0.003);
  };
  const double r = log_of(16), g = log_of(8), b = log_of(0);
  return {(r - g) / std::sqrt(2), (r + g - 2 * b) / std::sqrt(6)};
}

struct Watch {
  GstElement* element;
  std::vector<Frame> frames;
};

GstPadProbeReturn look(GstPad*, GstPadProbeInfo*, gpointer data) {
  auto& watch = *static_cast<Watch*>(data);
  GstStructure* stats = nullptr;
  g_object_get(watch.element, "stats", &stats, nullptr);
  if (const GValue* list = stats ? gst_structure_get_value(stats, "base-colors") : nullptr) {
    Frame frame;
    for (size_t k = 0; k < kSlots; ++k)
      if (const guint color =
              g_value_get_uint(gst_value_array_get_value(list, static_cast<guint>(k))))
        frame[k] = chroma_of(color);
    watch.frames.push_back(frame);
  }
  if (stats) gst_structure_free(stats);
  return GST_PAD_PROBE_OK;
}

double apart(const std::array<double, 2>& a, const std::array<double, 2>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

TEST(BaseColorNumbers, StayWithTheirColorsOverTheClip) {
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(
      "filesrc location=\"" MEDIA
      "/clip.webm\" ! matroskademux ! vp8dec ! videoconvert ! videoscale ! "
      "video/x-raw,width=320,height=240 ! globalintrinsic name=split ! intrinsiccompose ! "
      "fakesink sync=false",
      &error);
  ASSERT_NE(pipeline, nullptr) << error->message;
  Watch watch{gst_bin_get_by_name(GST_BIN(pipeline), "split"), {}};
  GstPad* pad = gst_element_get_static_pad(watch.element, "src");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, look, &watch, nullptr);
  gst_object_unref(pad);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstBus* bus = gst_element_get_bus(pipeline);
  GstMessage* message = gst_bus_timed_pop_filtered(
      bus, 300 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  ASSERT_NE(message, nullptr);
  EXPECT_EQ(GST_MESSAGE_TYPE(message), GST_MESSAGE_EOS);
  gst_message_unref(message);
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(watch.element);
  gst_object_unref(pipeline);

  ASSERT_GT(watch.frames.size(), 100U);
  Frame last;
  size_t seen = 0, kept = 0;
  for (size_t t = 0; t < watch.frames.size(); ++t)
    for (size_t k = 0; k < kSlots; ++k) {
      const auto& now = watch.frames[t][k];
      if (!now) continue;
      if (last[k]) {
        EXPECT_LT(apart(*now, *last[k]), 0.3) << "base color " << k << " is another in frame " << t;
      }
      last[k] = now;
    }
  for (size_t k = 0; k < kSlots; ++k) {
    size_t frames = 0;
    for (const Frame& frame : watch.frames) frames += frame[k].has_value();
    seen += frames > 0;
    kept += 4 * frames > 3 * watch.frames.size();
  }
  EXPECT_GE(seen, 5U);
  EXPECT_GE(kept, 4U) << "colors that are there in three quarters of the frames";
}

}  // namespace
