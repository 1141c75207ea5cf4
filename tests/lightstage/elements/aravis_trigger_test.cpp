// SPDX-License-Identifier: LGPL-2.1-or-later
// Lights and Aravis' camera in software in step: each software trigger is one frame, and each frame
// is labeled with the light it was exposed in.
#include <atomic>
#include <functional>
#include <map>
#include <mutex>

#include "aravis_fixture.hpp"
#include "common/error.hpp"
#include "gst/lightstage/sync/lights/camera_trigger.hpp"
#include "kernels/lightstage/triggers/triggered_capture.hpp"

namespace inverse::testing {
namespace {

const std::string kSmall = "video/x-raw,format=GRAY8,width=64,height=48";

class Lights : public LightDriver {
 public:
  void upload(const LightProgram&) override {}
  void show(uint64_t trigger) override { lit = static_cast<int64_t>(trigger); }
  void black() override { lit = -1; }
  std::atomic<int64_t> lit{-1};
};

/// Plays a line whose appsink `out` gives its frames to a capture.
class AravisTrigger : public FakeCamera {
 protected:
  struct Frame {
    uint64_t id = 0;
    std::optional<uint64_t> trigger;
    int64_t lit_on_arrival = 0;
    uint8_t first_pixel = 0;
  };

  LightProgram program(uint64_t passes) {
    LightProgram program;
    program.name = "test";
    program.lights = stage_lights({{0, 0, 1}});
    program.marker = LightProgram::Marker::start;
    program.repeat = passes;
    program.steps = {{StepKind::olat}};
    program.check();
    return program;
  }

  /// The trigger of the camera upstream of the appsink `out`.
  std::unique_ptr<CameraTrigger> trigger_upstream() {
    const std::unique_ptr<GstPad, decltype(&gst_object_unref)> pad(
        gst_element_get_static_pad(element("out"), "sink"), &gst_object_unref);
    return CameraTrigger::find(pad.get());
  }
  /// Plays a line, and finds that trigger.
  void find(const std::string& line, bool prepare = true) {
    for (int attempt = 0; attempt < 8; ++attempt) {
      make(line);
      trigger_ = trigger_upstream();
      if (prepare) trigger_->prepare();
      if (gst_element_set_state(pipeline_, GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE) {
        // Caps are there once the camera sends.
        GstPad* sink = gst_element_get_static_pad(element("out"), "sink");
        for (int i = 0; i < 500 && !gst_pad_has_current_caps(sink); ++i)
          std::this_thread::sleep_for(std::chrono::milliseconds(10));
        const bool sends = gst_pad_has_current_caps(sink);
        gst_object_unref(sink);
        ASSERT_TRUE(sends) << error(0);
        return;
      }
      error(0);
      trigger_.reset();
      close();
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
    }
    FAIL() << error_;
  }

  /// Runs the program; what came is in `got_`.
  void capture(const LightProgram& program, const TriggeredCapture::Params& params,
               double seconds = 60, const std::function<void()>& meanwhile = {}) {
    std::atomic<bool> ended{false};
    std::string failed;
    TriggeredCapture::Listener listener;
    listener.ended = [&] { ended = true; };
    listener.failed = [&](const Error& error) {
      failed = error.what();
      ended = true;
    };
    TriggeredCapture capture(program, lights_, {trigger_.get()}, params, listener);
    struct Context {
      AravisTrigger* test;
      TriggeredCapture* capture;
    } context{this, &capture};
    GstAppSinkCallbacks callbacks{};
    callbacks.new_sample = [](GstAppSink* sink, gpointer data) {
      auto& [test, capture] = *static_cast<Context*>(data);
      GstSample* sample = gst_app_sink_pull_sample(sink);
      if (!sample) return GST_FLOW_EOS;
      test->take_frame(gst_sample_get_buffer(sample), *capture);
      gst_sample_unref(sample);
      return GST_FLOW_OK;
    };
    GstElement* out = element("out");
    gst_app_sink_set_callbacks(GST_APP_SINK(out), &callbacks, &context, nullptr);
    capture.start();
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!ended && std::chrono::steady_clock::now() < until) {
      if (meanwhile) meanwhile();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_TRUE(ended) << "it hangs";
    capture.stop();
    stats_ = capture.stats();
    failed_ = failed;
    GstAppSinkCallbacks none{};
    gst_app_sink_set_callbacks(GST_APP_SINK(out), &none, nullptr, nullptr);
  }

  void take_frame(GstBuffer* buffer, TriggeredCapture& capture) {
    Frame frame;
    frame.id = GST_BUFFER_OFFSET(buffer);
    frame.lit_on_arrival = lights_.lit;
    gst_buffer_extract(buffer, 0, &frame.first_pixel, 1);
    GstClock* clock = gst_element_get_clock(pipeline_);
    std::optional<double> age;
    if (clock && trigger_->has_times()) {
      const auto now = static_cast<double>(gst_clock_get_time(clock)) -
                       static_cast<double>(gst_element_get_base_time(pipeline_));
      age = (now - static_cast<double>(GST_BUFFER_PTS(buffer))) * 1e-9;
    }
    gst_clear_object(&clock);
    frame.trigger = capture.frame(
        0, trigger_->frame_id_bits() ? std::optional<uint64_t>(frame.id) : std::nullopt, age);
    {
      const std::lock_guard lock(mutex_);
      got_.push_back(frame);
    }
    capture.done(0);
  }

  /// Every label once and in order, and the light was that on all the way.
  void expect_labels(uint64_t count) {
    uint64_t next = 0;
    for (const Frame& frame : got_) {
      if (!frame.trigger) continue;
      EXPECT_EQ(*frame.trigger, next++);
      EXPECT_EQ(static_cast<int64_t>(*frame.trigger), frame.lit_on_arrival);
    }
    EXPECT_EQ(next, count);
  }

  Lights lights_;
  std::unique_ptr<CameraTrigger> trigger_;
  std::mutex mutex_;
  std::vector<Frame> got_;
  TriggeredCapture::Stats stats_;
  std::string failed_;
};

TEST_F(AravisTrigger, EachTriggerIsOneFrame) {
  // Through whatever stands between.
  ASSERT_NO_FATAL_FAILURE(
      find("bin. ( name=inside " + source() + " ! " + kSmall +
           " ! queue ) ! queue ! identity ! appsink name=out sync=false max-buffers=4"));
  EXPECT_EQ(trigger_->name(), "camera");
  trigger_->configure();
  EXPECT_EQ(trigger_->frame_id_bits(), 16U);
  capture(program(150), {.timeout = 2});  // three of the marker before
  EXPECT_EQ(failed_, "");
  EXPECT_EQ(stats_.triggers, 153U);
  EXPECT_EQ(stats_.dropped + stats_.surplus + stats_.ambiguous + stats_.early, 0U);
  expect_labels(153);
  ASSERT_GE(got_.size(), 153U);
  // The camera counted nothing but these, and its count wrapped.
  EXPECT_EQ(got_.front().id, 65401U);
  EXPECT_EQ(got_.back().id, 65401U + 152 - 65535);
  for (const Frame& frame : got_) EXPECT_EQ(frame.first_pixel, frame.id % 255);
  trigger_.reset();
}

/// A source without trigger properties, as aravissrc, runs freely by default.
TEST_F(AravisTrigger, ACameraThatRunsFreelyIsTakenOver) {
  ASSERT_NO_FATAL_FAILURE(
      find(source("timeout=0") + " ! " + kSmall + " ! appsink name=out sync=false max-buffers=4",
           false));
  take(3);
  ASSERT_EQ(frames_.size(), 3U) << error(0);
  trigger_->configure();
  take(100, .5);  // what was on its way
  const size_t before = frames_.size();
  take(1, .5);
  EXPECT_EQ(frames_.size(), before) << "it runs on";
  capture(program(20), {});
  EXPECT_EQ(failed_, "");
  expect_labels(23);
  trigger_.reset();
}

TEST_F(AravisTrigger, LostFramesAreTakenAgainInTheSameLight) {
  ASSERT_NO_FATAL_FAILURE(start_camera("20"));  // of a thousand packets, and a frame has five
  ASSERT_NO_FATAL_FAILURE(
      find(source() + " ! " + kSmall + " ! appsink name=out sync=false max-buffers=4"));
  trigger_->configure();
  capture(program(120), {.timeout = .5, .retries = 5}, 120);
  EXPECT_EQ(failed_, "");
  EXPECT_EQ(stats_.triggers + stats_.dropped, 123U);
  EXPECT_GE(stats_.retried, 2U);
  EXPECT_LE(stats_.dropped, 2U);
  uint64_t labels = 0;
  for (const Frame& frame : got_) {
    labels += frame.trigger.has_value();
    if (frame.trigger) {
      EXPECT_EQ(static_cast<int64_t>(*frame.trigger), frame.lit_on_arrival);
    }
  }
  EXPECT_EQ(labels, stats_.triggers);
  trigger_.reset();
}

TEST_F(AravisTrigger, ACameraThatDisappearsIsAnError) {
  ASSERT_NO_FATAL_FAILURE(
      find(source() + " ! " + kSmall + " ! appsink name=out sync=false max-buffers=4"));
  trigger_->configure();
  std::atomic<bool> dead{false};
  const auto began = std::chrono::steady_clock::now();
  capture(program(0), {}, 60, [&] {
    const std::lock_guard lock(mutex_);
    if (got_.size() > 5 && !dead.exchange(true)) fake_.reset();
  });
  expect_contains(failed_, "camera refused the trigger");
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(30));
  trigger_.reset();
}

TEST_F(AravisTrigger, AMissingCameraIsAnErrorWithItsRemedy) {
  make("videotestsrc ! queue ! appsink name=out");
  expect_error(ErrorKind::unsupported, "no camera to trigger upstream",
               [&] { trigger_upstream(); });
  close();
  make("lightstagearavissrc name=camera trigger-source=Line0 ! appsink name=out");
  trigger_ = trigger_upstream();
  expect_error(ErrorKind::unsupported, "has trigger-source=Line0", [&] { trigger_->prepare(); });
  expect_error(ErrorKind::internal, "was not made ready", [&] { trigger_->fire(); });
}

}  // namespace
}  // namespace inverse::testing
