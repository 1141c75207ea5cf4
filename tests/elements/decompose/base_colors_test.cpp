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

/// The base colors in an element's stats; nothing without any.
std::optional<Frame> base_colors_of(GstElement* element) {
  const Structure stats(property<GstStructure*>(element, "stats"), &gst_structure_free);
  const GValue* list = stats ? gst_structure_get_value(stats.get(), "base-colors") : nullptr;
  if (!list) return {};
  Frame frame;
  for (size_t k = 0; k < kSlots; ++k)
    if (const guint color =
            g_value_get_uint(gst_value_array_get_value(list, static_cast<guint>(k))))
      frame[k] = chroma_of(color);
  return frame;
}

double apart(const std::array<double, 2>& a, const std::array<double, 2>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

TEST(BaseColorNumbers, StayWithTheirColorsOverTheClip) {
  std::vector<Frame> frames;
  const LineResult result =
      run_line("filesrc location=\"" MEDIA
               "/clip.webm\" ! matroskademux ! vp8dec ! videoconvert ! videoscale ! "
               "video/x-raw,width=320,height=240 ! globalintrinsic name=split ! intrinsiccompose ! "
               "fakesink sync=false",
               300, [&](GstElement* pipeline) {
                 GstElement* element = find_element(pipeline, "split");
                 watch_buffers(element, "src", [&frames, element](GstBuffer*) {
                   if (const auto colors = base_colors_of(element)) frames.push_back(*colors);
                 });
               });
  ASSERT_TRUE(result.eos) << result.first_error();

  ASSERT_GT(frames.size(), 100U);
  Frame last;
  size_t seen = 0, kept = 0;
  for (size_t t = 0; t < frames.size(); ++t)
    for (size_t k = 0; k < kSlots; ++k) {
      const auto& now = frames[t][k];
      if (!now) continue;
      if (last[k]) {
        // Where a color is about to become two, it moves: by up to .38 at slopes of light up to .3.
        EXPECT_LT(apart(*now, *last[k]), 0.4) << "base color " << k << " is another in frame " << t;
      }
      last[k] = now;
    }
  for (size_t k = 0; k < kSlots; ++k) {
    size_t found = 0;
    for (const Frame& frame : frames) found += frame[k].has_value();
    seen += found > 0;
    kept += 4 * found > 3 * frames.size();
  }
  EXPECT_GE(seen, 5U);
  EXPECT_GE(kept, 4U) << "colors that are there in three quarters of the frames";
}

}  // namespace
}  // namespace inverse::testing
