// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/controller/controller.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "gst/inverse/inverse_layers_meta.h"
#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"

namespace inverse::testing {

/// RGBA: two paints side by side, under light that steps down at two thirds of the height and has
/// the noise of a camera.
inline std::vector<uint8_t> lit_paints(int width, int height, unsigned seed = 4) {
  std::mt19937 random(seed);
  return draw(width, height, [&](int x, int y, int c) {
    constexpr int kPaint[2][3] = {{210, 60, 50}, {60, 90, 200}};
    const int light = 100 - (y > 2 * height / 3 ? 45 : 0) - 20 * x / width;
    const int code = kPaint[x >= width / 2][c] * light / 100;
    return std::clamp(code + static_cast<int>(random() % 3) - 1, 0, 255);
  });
}

/// Largest difference of the left (false) or right (true) half of RGBA frames.
inline int half_difference(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b, int width,
                           bool right) {
  int largest = a.size() == b.size() ? 0 : 256;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    if ((static_cast<int>(i / 4) % width >= width / 2) == right)
      largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

/// Dispatches of the last frame of an element that hands layers on, which does not wait: of a
/// stream that is over.
inline guint dispatches_of(VideoHarness& harness, const char* factory) {
  return stat<guint>(harness.find(factory), "dispatches");
}

/// Lets a float property go from `from` to `to` in a second of stream time.
inline void ramp(GstElement* element, const char* property, double from, double to) {
  GstControlSource* source = gst_interpolation_control_source_new();
  g_object_set(source, "mode", GST_INTERPOLATION_MODE_LINEAR, nullptr);
  ASSERT_TRUE(gst_object_add_control_binding(
      GST_OBJECT(element),
      gst_direct_control_binding_new_absolute(GST_OBJECT(element), property, source)))
      << property;
  auto* values = GST_TIMED_VALUE_CONTROL_SOURCE(source);
  gst_timed_value_control_source_set(values, 0, from);
  gst_timed_value_control_source_set(values, GST_SECOND, to);
  gst_object_unref(source);
}

/// Expects that a line of elements takes frames of any format and size, and gives as many bytes.
inline void expect_any_format_and_size(const std::string& line) {
  for (const char* format : {"RGBA", "GRAY8", "NV12", "RGB"})
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {15, 10}, {349, 287}}) {
      const std::string caps = VideoHarness::caps(format, width, height);
      VideoHarness harness(line, caps, caps);
      const auto picture = random_frame(caps, 1);
      EXPECT_EQ(harness.process(picture, 2).size(), picture.size()) << line << caps;
      EXPECT_TRUE(harness.errors().empty()) << line << caps;
    }
}

/// An editor of layers and a frame of lit paints.
class EditorElement : public ::testing::Test {
 protected:
  static constexpr int kWidth = 96, kHeight = 64;
  static constexpr const char* kGlobal =
      "video/x-raw(" GST_CAPS_FEATURE_META_INVERSE_LAYERS "), layers=(string)global";

  static std::string rgba() { return VideoHarness::caps("RGBA", kWidth, kHeight); }
  /// A decomposed frame's way through an editor.
  static std::string line(const std::string& editor, const std::string& settings = "") {
    return "intrinsicdecomp ! " + editor + " " + settings + " ! intrinsiccompose";
  }

  /// Expects that settings with which an editor changes nothing cost nothing.
  void expect_neutral(const std::string& editor, const std::vector<std::string>& settings) {
    VideoHarness without("intrinsicdecomp ! intrinsiccompose", rgba(), rgba());
    const auto expected = without.process(frame, 4);
    for (const std::string& some : settings) {
      VideoHarness harness(line(editor, some), rgba(), rgba());
      EXPECT_LE(largest_difference(harness.process(frame, 3), frame), 1) << some;
      EXPECT_EQ(dispatches_of(harness, editor.c_str()), 0u) << some;
      EXPECT_EQ(harness.process(frame), expected) << some;
    }
  }

  /// Expects that the frame changes more and more, every so many frames, as `strength` goes up.
  void expect_strength_follows_a_controller(VideoHarness& harness, GstElement* editor, int every) {
    ramp(editor, "strength", 0, 1);
    int before = 0;
    for (int n = 0; n < 25; ++n) {
      const int change = largest_difference(harness.process(frame), frame);
      if (n == 0) {
        EXPECT_LE(change, 1);
      }
      if (n % every == every - 1) {
        EXPECT_GT(change, before + 10) << n;
        before = change;
      }
    }
  }

  /// Expects that a mask of the paint at the right confines an editor that changes both.
  void expect_confined_by_a_mask(const std::string& editor) {
    const std::string masked =
        "intrinsicrecolor key=0xff3c5ac8 strength=0 write-mask=true ! " + editor;
    const auto confined = VideoHarness(line(masked), rgba(), rgba()).process(frame);
    EXPECT_GT(half_difference(confined, frame, kWidth, true), 25);
    EXPECT_LE(half_difference(confined, frame, kWidth, false), 1);
    const auto all = VideoHarness(line(masked, "use-mask=false"), rgba(), rgba()).process(frame);
    EXPECT_GT(half_difference(all, frame, kWidth, false), 25);
  }

  const std::vector<uint8_t> frame = lit_paints(kWidth, kHeight);
};

}  // namespace inverse::testing
