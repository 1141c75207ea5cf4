// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/controller/controller.h>

#include <algorithm>
#include <string>
#include <vector>

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

}  // namespace inverse::testing
