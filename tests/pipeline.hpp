// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/app/gstappsink.h>
#include <gtest/gtest.h>

#include "tests/gstreamer.hpp"

namespace inverse::testing {

/// A launch line as a pipeline, which is stopped at the end whatever happens.
class Pipeline {
 public:
  explicit Pipeline(const std::string& line) {
    GError* error = nullptr;
    pipeline_ = gst_parse_launch(line.c_str(), &error);
    EXPECT_EQ(error, nullptr) << error->message << ": " << line;
    g_clear_error(&error);
    bus_ = gst_element_get_bus(pipeline_);
  }
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;
  ~Pipeline() {
    set(GST_STATE_NULL);
    gst_object_unref(bus_);
    gst_object_unref(pipeline_);
  }

  GstElement* get() const { return pipeline_; }
  GstBus* bus() const { return bus_; }
  GstElement* find(const char* name) const { return find_element(pipeline_, name); }
  GstStateChangeReturn set(GstState state) { return gst_element_set_state(pipeline_, state); }
  bool reaches(GstState state) {
    return set(state) != GST_STATE_CHANGE_FAILURE &&
           gst_element_get_state(pipeline_, nullptr, nullptr, 60 * GST_SECOND) ==
               GST_STATE_CHANGE_SUCCESS;
  }
  /// The next sample of the appsink of this name; null if none comes within a minute.
  GstSample* sample(const char* sink) {
    return gst_app_sink_try_pull_sample(GST_APP_SINK(find(sink)), 60 * GST_SECOND);
  }
  /// Waits for the end of the stream.
  bool ends() { return waited_for(GST_MESSAGE_EOS) == GST_MESSAGE_EOS; }
  /// The type of the first of these messages; unknown without one within a minute.
  GstMessageType waited_for(int types) {
    GstMessage* message =
        gst_bus_timed_pop_filtered(bus_, 60 * GST_SECOND, static_cast<GstMessageType>(types));
    const GstMessageType type = message ? GST_MESSAGE_TYPE(message) : GST_MESSAGE_UNKNOWN;
    if (message) gst_message_unref(message);
    return type;
  }
  /// The first error within so many seconds; empty without one.
  std::string error(double seconds = 60) { return next_text(bus_, GST_MESSAGE_ERROR, seconds); }

 private:
  GstElement* pipeline_ = nullptr;
  GstBus* bus_ = nullptr;
};

}  // namespace inverse::testing
