// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync: streams that end, restart, break off and resume.
#include <atomic>
#include <thread>

#include "stage_fixture.hpp"

namespace inverse::testing {
namespace {

class StageStreams : public StageSync {
 protected:
  bool begin(const char* name, unsigned number = 0) {
    return gst_harness_push_event(camera(number), gst_event_new_stream_start(name));
  }
};

TEST_F(StageStreams, AnotherStreamWithoutAnEndOfTheLastOneGoesOn) {
  start_performance();
  push_all(-10, 0);  // some are held
  ASSERT_TRUE(begin("another"));
  push_all(-10, 30);
  const auto frames = pull(30);
  EXPECT_EQ(frames.back().trigger, 29);
  EXPECT_EQ(count("before-marker"), 20u);
}

TEST_F(StageStreams, FramesWithoutAnEndedCameraAreReportedOnce) {
  start_performance(2);
  push_all(-10, 20, 2);
  ASSERT_TRUE(gst_harness_push_event(camera(1), gst_event_new_eos()));
  push_all(20, 40);
  EXPECT_TRUE(warnings().empty()) << "streams may end a little apart";
  push_all(40, 120);
  expect_one(warnings(), "sink_1 has ended");
  EXPECT_EQ(count("incomplete"), 100u);
}

TEST_F(StageStreams, LabelsGoOnInAnotherFrame) {
  start_performance();
  push_all(-10, 40);
  int64_t next = 40;
  for (const auto& [width, height] : {std::pair{160, 32}, {kWidth, 90}, {kWidth, kHeight}}) {
    start(0, caps(width, height));
    push_all(BallOnStage(program_, width, height), next, next + 30);
    next += 30;
  }
  EXPECT_EQ(pull(130).back().trigger, 129);
  EXPECT_EQ(count("contradicted"), 0u);
}

TEST_F(StageStreams, AStreamMayFollowAnEnd) {
  start_performance();
  for (const char* name : {"one", "two", "two", "three"}) {
    ASSERT_TRUE(begin(name));
    push_all(-10, 20);
    ASSERT_TRUE(push_end());
    EXPECT_EQ(push(20), GST_FLOW_EOS);
    // Also before the end has left.
    if (std::string(name) == "one") {
      EXPECT_EQ(pull(20).back().trigger, 19);
      EXPECT_TRUE(ends());
    }
  }
  EXPECT_EQ(pull(60).back().trigger, 19);
  EXPECT_EQ(count("labeled"), 80u);
  EXPECT_EQ(count("sent"), 80u);
}

TEST_F(StageStreams, TwoCamerasGoOnTogetherAfterOneWasCovered) {
  LightProgram program = performance(stage_lights(geodesic_directions(42)));
  while (program.steps.size() < 40)
    program.steps.push_back(program.steps[program.steps.size() % 2]);
  program.marker = LightProgram::Marker::pass;
  use(program);
  g_object_set(element_, "tuning", "max-frames=200", nullptr);
  start(0);
  start(1);
  const BallOnStage ball(program_, kWidth, kHeight);
  for (int64_t n = -10; n < 400; ++n) {
    ASSERT_EQ(push(n, 0), GST_FLOW_OK);
    const int64_t seen = n >= 220 && n < 230 ? -1 : n;
    ASSERT_EQ(push(ball.draw(seen, 0, static_cast<unsigned>(n + 20)), static_cast<double>(n), 1),
              GST_FLOW_OK);
  }
  const guint64 complete = count("sets-complete");
  EXPECT_GT(complete, 350u);  // all but one pass
  const auto one = pull(complete, 0), other = pull(complete, 1);
  for (size_t i = 0; i < complete; ++i) EXPECT_EQ(one[i].trigger, other[i].trigger) << i;
  EXPECT_EQ(one.back().trigger, 399);
}

TEST_F(StageStreams, LosingAnUnmarkedProgramIsAWarningWithItsRemedy) {
  LightProgram program = static_capture(stage_lights(geodesic_directions(42)));
  program.marker = LightProgram::Marker::none;
  use(program);
  start();
  const BallOnStage ball(program_, kWidth, kHeight);
  for (int64_t n = 0; n < 60; ++n)
    ASSERT_EQ(push(ball.draw(n), static_cast<double>(n) + (n < 20 ? 1000 : -50.5)), GST_FLOW_OK);
  EXPECT_LE(count("labeled"), 20u);
  for (const Out& frame : pull(count("labeled"))) EXPECT_LT(frame.trigger, 20);
  ASSERT_TRUE(push_end());
  EXPECT_TRUE(warned_of("the program has no marker"));
}

TEST_F(StageStreams, CamerasMayGoWhileTheyAreFlushed) {
  start_performance();
  push_all(-10, 10);
  for (int64_t n = 10; n < 110; ++n) {
    GstPad* pad = gst_element_request_pad_simple(element_, "sink_1");
    ASSERT_NE(pad, nullptr);
    std::atomic<bool> stop{false};
    std::thread flusher([&] {
      while (!stop) {
        gst_pad_send_event(pad, gst_event_new_flush_start());
        gst_pad_send_event(pad, gst_event_new_flush_stop(TRUE));
      }
    });
    g_usleep(static_cast<gulong>(n) * 10);
    gst_element_release_request_pad(element_, pad);
    ASSERT_EQ(push(n), GST_FLOW_OK);
    stop = true;
    flusher.join();
    gst_object_unref(pad);
  }
  EXPECT_EQ(pull(110).back().trigger, 109);
}

}  // namespace
}  // namespace inverse::testing
