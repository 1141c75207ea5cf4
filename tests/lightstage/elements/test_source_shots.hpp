// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "gst/inverse/inverse_light_stage_meta.h"
#include "tests/elements/element_test.hpp"

namespace inverse::testing {

struct Frame {
  GstClockTime time, duration;
  guint64 offset;
  bool labeled = false;
  GstLightStageMeta meta{};  // without its colors
  std::vector<float> colors;
};

/// What a line sends, with what its buffers say.
struct Shots {
  LineResult line;
  std::vector<Frame> frames;
};

inline Frame frame_of(GstBuffer* buffer) {
  Frame frame{GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer), GST_BUFFER_OFFSET(buffer)};
  if (const GstLightStageMeta* meta = gst_buffer_get_light_stage_meta(buffer)) {
    frame.labeled = true;
    frame.meta = *meta;
    frame.colors = floats_of(meta->colors);
  }
  return frame;
}

/// `source` is what follows "lightstagetestsrc", `caps` what its frames are.
inline Shots shoot(const std::string& source,
                   const std::string& caps = "format=GRAY8,width=16,height=16",
                   const std::function<void(GstElement*)>& prepare = {}) {
  Shots shots;
  shots.line = run_line("lightstagetestsrc name=camera " + source + " ! video/x-raw," + caps +
                            " ! appsink name=out sync=false",
                        120, [&](GstElement* pipeline) {
                          watch_buffers(
                              find_element(pipeline, "out"), "sink",
                              [&](GstBuffer* buffer) { shots.frames.push_back(frame_of(buffer)); });
                          if (prepare) prepare(pipeline);
                        });
  return shots;
}

inline std::string linear16(int width, int height) {
  return "format=RGBA64_LE,colorimetry=(string)1:1:1:1,width=" + std::to_string(width) +
         ",height=" + std::to_string(height);
}

inline std::vector<double> samples(const std::vector<uint8_t>& frame) {
  std::vector<double> values(frame.size() / 2);
  for (size_t i = 0; i < values.size(); ++i) {
    uint16_t value = 0;
    memcpy(&value, &frame[2 * i], 2);
    values[i] = value;
  }
  return values;
}

/// The first error of a line; empty without one.
inline std::string error_of(const std::string& source, const std::string& caps = "format=RGBA") {
  return shoot("is-live=false num-buffers=2 " + source, caps).line.first_error();
}

}  // namespace inverse::testing
