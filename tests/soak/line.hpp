// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/gst.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/gstreamer.hpp"

namespace inverse::soak {

using Clock = std::chrono::steady_clock;

/// A pipeline that counts the frames at its end.
class Line {
 public:
  /// Its decomposer is named "decomposer" and its end "sink"; a fakesink there with handoffs
  /// counts.
  explicit Line(const std::string& text) {
    GError* error = nullptr;
    pipeline_ = gst_parse_launch(text.c_str(), &error);
    if (error) {
      const std::string reason = error->message;
      g_error_free(error);
      throw std::runtime_error(text + ": " + reason);
    }
    decomposer_ = find("decomposer");
    bus_ = gst_element_get_bus(pipeline_);
    GstElement* sink = find("sink");
    if (g_signal_lookup("handoff", G_OBJECT_TYPE(sink)))
      g_signal_connect(
          sink, "handoff",
          G_CALLBACK(+[](GstElement*, GstBuffer*, GstPad*, Line* self) { ++self->frames_; }), this);
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  ~Line() {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(bus_);
    gst_object_unref(pipeline_);
  }

  GstElement* find(const char* name) const { return testing::find_element(pipeline_, name); }
  unsigned frames() const { return frames_; }

  void set_state(GstState state) {
    if (gst_element_set_state(pipeline_, state) == GST_STATE_CHANGE_FAILURE) {
      check();
      throw std::runtime_error(std::string("cannot go to ") + gst_element_state_get_name(state));
    }
  }
  /// Waits for this number of frames at the sink.
  void wait_for(unsigned frames) {
    auto moved = Clock::now();
    for (unsigned seen = frames_; frames_ < frames;) {
      check();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      if (frames_ != seen) {
        seen = frames_;
        moved = Clock::now();
      } else if (Clock::now() - moved > std::chrono::minutes(1)) {
        throw std::runtime_error("no frame for a minute after frame " + std::to_string(seen));
      }
    }
  }
  void wait_for_end() {
    GstMessage* message = gst_bus_timed_pop_filtered(
        bus_, 60 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
    if (!message) throw std::runtime_error("no end of stream within a minute");
    const bool failed = GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR;
    const std::string reason = failed ? text_of(message) : "";
    gst_message_unref(message);
    if (failed) throw std::runtime_error(reason);
  }
  void seek(GstClockTime time) {
    if (!gst_element_seek_simple(pipeline_, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                                 static_cast<gint64>(time)))
      throw std::runtime_error("a seek was refused");
  }
  /// The stats of its decomposer.
  uint64_t device_bytes() const {
    GstStructure* stats = nullptr;
    g_object_get(decomposer_, "stats", &stats, nullptr);
    guint64 bytes = 0;
    const bool found = stats && gst_structure_get_uint64(stats, "device-bytes", &bytes);
    if (stats) gst_structure_free(stats);
    if (!found || bytes == 0) throw std::runtime_error("stats lack device-bytes");
    return bytes;
  }
  /// Throws the pipeline's error, if any.
  void check() {
    if (GstMessage* message = gst_bus_pop_filtered(bus_, GST_MESSAGE_ERROR)) {
      const std::string reason = text_of(message);
      gst_message_unref(message);
      throw std::runtime_error(reason);
    }
    while (GstMessage* other = gst_bus_pop_filtered(
               bus_, static_cast<GstMessageType>(GST_MESSAGE_ANY & ~GST_MESSAGE_ERROR &
                                                 ~GST_MESSAGE_EOS)))
      gst_message_unref(other);
  }

 private:
  static std::string text_of(GstMessage* message) {
    return std::string(GST_OBJECT_NAME(GST_MESSAGE_SRC(message))) + ": " +
           testing::text_of(message);
  }

  GstElement* pipeline_ = nullptr;
  GstElement* decomposer_ = nullptr;
  GstBus* bus_ = nullptr;
  std::atomic<unsigned> frames_{0};
};

}  // namespace inverse::soak
