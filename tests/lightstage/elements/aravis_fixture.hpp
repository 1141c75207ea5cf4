// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/elements/element_test.hpp"
#include "tests/has_element.hpp"
#include "tests/pipelines/process.hpp"

namespace inverse::testing {

/// Aravis' industrial camera in software on loopback: GigE Vision 1.x, frame ids from 65400 on. Its
/// pictures are diagonal ramps that show their ids.
class FakeCamera : public ::testing::Test {
 protected:
  void SetUp() override {
    if (system("command -v arv-fake-gv-camera-0.8 >/dev/null") != 0)
      GTEST_SKIP() << "arv-fake-gv-camera-0.8 is missing: install aravis-tools";
    if (!has_element("lightstagearavissrc"))
      GTEST_SKIP() << "the plugin was built without Aravis: install libaravis-dev";
    start_camera();
  }
  void TearDown() override {
    forget();
    close();
  }

  /// Starts the camera anew; it loses so many of a thousand packets. One at a time on a machine.
  void start_camera(const std::string& lost = "0") {
    static int count = 0;
    fake_.reset();
    serial_ = "gi" + std::to_string(getpid()) + "x" + std::to_string(count++);
    for (int attempt = 0; attempt < 60; ++attempt) {
      fake_ = std::make_unique<Process>(std::vector<std::string>{
          "arv-fake-gv-camera-0.8", "-i", "127.0.0.1", "-s", serial_, "-r", lost});
      if (fake_->wait(.5) == -1) return;
    }
    FAIL() << "another one runs on this machine: " << fake_->output();
  }
  std::string source(const std::string& more = "") const {
    return "lightstagearavissrc name=camera camera-name=Aravis-Fake-" + serial_ +
           " exposure=10000 " + more;
  }

  /// Makes a line and lets it play. The camera may need a moment to be found.
  void play(const std::string& line) {
    for (int attempt = 0; attempt < 8; ++attempt) {
      make(line);
      if (gst_element_set_state(pipeline_, GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE) return;
      error(0);
      close();
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
    }
    FAIL() << error_;
  }
  void make(const std::string& line) {
    GError* error = nullptr;
    pipeline_ = gst_parse_launch(line.c_str(), &error);
    ASSERT_EQ(error, nullptr) << error->message;
    bus_ = gst_element_get_bus(pipeline_);
  }
  void close() {
    if (!pipeline_) return;
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(bus_);
    gst_clear_object(&pipeline_);
  }
  /// The first error within so many seconds, "" where there is none.
  std::string error(double seconds) { return message(GST_MESSAGE_ERROR, seconds); }
  std::string message(GstMessageType type, double seconds) {
    std::string text = next_text(bus_, type, seconds);
    if (!text.empty()) error_ = text;
    return text;
  }

  /// Takes frames from the appsink `out` and holds them. Fewer where they stop coming.
  void take(size_t count, double seconds = 10) {
    for (size_t i = 0; i < count; ++i) {
      GstSample* sample = gst_app_sink_try_pull_sample(
          GST_APP_SINK(element("out")), static_cast<GstClockTime>(seconds * GST_SECOND));
      if (!sample) break;
      frames_.push_back(gst_buffer_ref(gst_sample_get_buffer(sample)));
      gst_sample_unref(sample);
    }
  }
  /// The same where all of them have to come.
  void take_all(size_t count) {
    const size_t before = frames_.size();
    take(count);
    ASSERT_EQ(frames_.size(), before + count) << error(0);
  }
  void forget() {
    for (GstBuffer* buffer : frames_) gst_buffer_unref(buffer);
    frames_.clear();
  }
  GstElement* element(const char* name) { return find_element(pipeline_, name); }
  guint64 camera_stat(const char* name) { return stat<guint64>(element("camera"), name); }

  std::string serial_, error_;
  std::unique_ptr<Process> fake_;
  GstElement* pipeline_ = nullptr;
  GstBus* bus_ = nullptr;
  std::vector<GstBuffer*> frames_;
};

}  // namespace inverse::testing
