// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
// Frames of a clip in memory, for benchmarks through the elements.
#include <gst/app/gstappsink.h>

#include <limits>
#include <string>
#include <vector>

namespace inverse::bench {

/// The first frames of a file, at most `max`, converted and scaled to `caps` and copied, so that
/// they are alike in where they lie. Fewer, or none, where it ends or cannot be read.
inline std::vector<GstBuffer*> load_clip(const std::string& path, const std::string& caps,
                                         size_t max = std::numeric_limits<size_t>::max()) {
  const std::string line = "filesrc location=\"" + path +
                           "\" ! decodebin ! videoconvert ! videoscale ! " + caps +
                           ", pixel-aspect-ratio=1/1 ! appsink name=out sync=false";
  std::vector<GstBuffer*> frames;
  GstElement* pipeline = gst_parse_launch(line.c_str(), nullptr);
  if (!pipeline) return frames;
  GstElement* sink = gst_bin_get_by_name(GST_BIN(pipeline), "out");
  GstBus* bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  while (frames.size() < max && !gst_app_sink_is_eos(GST_APP_SINK(sink))) {
    GstSample* sample = gst_app_sink_try_pull_sample(GST_APP_SINK(sink), GST_SECOND / 10);
    if (!sample) {  // the sink waits for good where what is before it failed
      GstMessage* failed = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
      if (!failed) continue;
      gst_message_unref(failed);
      break;
    }
    frames.push_back(gst_buffer_copy_deep(gst_sample_get_buffer(sample)));
    gst_sample_unref(sample);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(bus);
  gst_object_unref(sink);
  gst_object_unref(pipeline);
  return frames;
}

}  // namespace inverse::bench
