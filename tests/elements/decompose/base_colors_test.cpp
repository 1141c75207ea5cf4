// SPDX-License-Identifier: LGPL-2.1-or-later
// Numbers of base colors over the bundled clip, in which a lamp and a ball move.
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "gst/base/color.hpp"
#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

constexpr size_t kSlots = 16;
using Frame = std::array<std::optional<std::array<double, 2>>, kSlots>;

/// Log chroma of 0xAARRGGBB.
std::array<double, 2> chroma_of(guint color) {
  const std::array<float, 3> linear = linear_color(color);
  const auto log_of = [&](size_t c) { return std::log(static_cast<double>(linear[c]) + 0.003); };
  const double r = log_of(0), g = log_of(1), b = log_of(2);
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
  Watch watch{};
  const LineResult result =
      run_line("filesrc location=\"" MEDIA
               "/clip.webm\" ! matroskademux ! vp8dec ! videoconvert ! videoscale ! "
               "video/x-raw,width=320,height=240 ! globalintrinsic name=split ! intrinsiccompose ! "
               "fakesink sync=false",
               300, [&](GstElement* pipeline) {
                 watch.element = gst_bin_get_by_name(GST_BIN(pipeline), "split");
                 GstPad* pad = gst_element_get_static_pad(watch.element, "src");
                 gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, look, &watch, nullptr);
                 gst_object_unref(pad);
                 gst_object_unref(watch.element);  // the pipeline keeps it
               });
  ASSERT_TRUE(result.eos) << result.first_error();

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
}  // namespace inverse::testing
