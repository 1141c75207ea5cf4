// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync: streams that end, restart, break off and resume.
#include <atomic>
#include <future>
#include <mutex>
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

TEST_F(StageStreams, NoFrameFollowsOneThatFailed) {
  start_performance();
  std::atomic<int> sent{0};
  GstPad* pad = gst_element_get_static_pad(element_, "src_0");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo* info, gpointer data) {
        ++*static_cast<std::atomic<int>*>(data);
        gst_buffer_unref(GST_PAD_PROBE_INFO_BUFFER(info));
        GST_PAD_PROBE_INFO_FLOW_RETURN(info) = GST_FLOW_ERROR;
        return GST_PAD_PROBE_HANDLED;
      },
      &sent, nullptr);
  gst_object_unref(pad);
  int64_t trigger = -10;  // frames before the marker leave together
  while (trigger < 100 && push(trigger) == GST_FLOW_OK) ++trigger;
  EXPECT_EQ(push(trigger), GST_FLOW_ERROR);
  push_end();
  EXPECT_TRUE(ends());
  EXPECT_EQ(sent, 1);
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

class StageDrains : public StageStreams {
 protected:
  /// What leaves a camera's source pad, "frame" and "drain", in order.
  void watch(unsigned number = 0) {
    gst_pad_add_probe(camera(number)->sinkpad,
                      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER |
                                                   GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM),
                      note, this, nullptr);
  }
  bool drain(unsigned number = 0) {
    GstQuery* query = gst_query_new_drain();
    const bool drained = gst_pad_peer_query(camera(number)->srcpad, query);
    gst_query_unref(query);
    return drained;
  }
  std::vector<std::string> left() {
    std::lock_guard lock(mutex_);
    return left_;
  }

 private:
  static GstPadProbeReturn note(GstPad*, GstPadProbeInfo* info, gpointer data) {
    auto* self = static_cast<StageDrains*>(data);
    std::lock_guard lock(self->mutex_);
    if (info->type & GST_PAD_PROBE_TYPE_BUFFER)
      self->left_.emplace_back("frame");
    else if ((info->type & GST_PAD_PROBE_TYPE_PUSH) &&
             GST_QUERY_TYPE(GST_PAD_PROBE_INFO_QUERY(info)) == GST_QUERY_DRAIN)
      self->left_.emplace_back("drain");
    return GST_PAD_PROBE_OK;
  }
  std::mutex mutex_;
  std::vector<std::string> left_;
};

TEST_F(StageDrains, FramesThatWaitForTheirLabelsGoFirst) {
  use(static_capture(stage_lights(geodesic_directions(42))));
  g_object_set(element_, "tuning", "drop-unlabeled=false", nullptr);
  start();
  watch();
  push_all(-10, 8);  // single lights wait for the tracking frame after them
  EXPECT_TRUE(drain());
  std::vector<std::string> expected(18, "frame");
  expected.emplace_back("drain");
  EXPECT_EQ(left(), expected);
  push_all(8, 54);
  const auto frames = pull(60);
  EXPECT_EQ(frames[18].trigger, 8) << "labels go on";
  EXPECT_EQ(frames.back().trigger, 49);
}

// Decoders drain when caps change; a seek or a stop may come meanwhile.
TEST_F(StageDrains, AFlushEndsOneBehindFramesThatCannotLeave) {
  use_performance();
  g_object_set(element_, "tuning", "drop-unlabeled=false", nullptr);
  start();
  gst_pad_add_probe(
      camera()->sinkpad,
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BLOCK | GST_PAD_PROBE_TYPE_BUFFER),
      [](GstPad*, GstPadProbeInfo*, gpointer) { return GST_PAD_PROBE_OK; }, nullptr, nullptr);
  push_all(-10, -7);
  auto draining = std::async(std::launch::async, [&] { return drain(); });
  EXPECT_EQ(draining.wait_for(std::chrono::milliseconds(200)), std::future_status::timeout);
  gst_harness_push_event(camera(), gst_event_new_flush_start());
  ASSERT_EQ(draining.wait_for(std::chrono::seconds(30)), std::future_status::ready);
  EXPECT_FALSE(draining.get());
  gst_harness_push_event(camera(), gst_event_new_flush_stop(TRUE));
  EXPECT_EQ(gst_element_set_state(element_, GST_STATE_NULL), GST_STATE_CHANGE_SUCCESS);
}

TEST_F(StageDrains, FramesThatWaitForAnotherCameraGoFirst) {
  use_performance();
  g_object_set(element_, "timeout", 60.0, nullptr);
  start(0);
  start(1);
  watch();
  push_all(-10, 20, 2);
  push_all(20, 25);
  pull(20);
  auto draining = std::async(std::launch::async, [&] { return drain(); });
  EXPECT_EQ(draining.wait_for(std::chrono::milliseconds(100)), std::future_status::timeout);
  EXPECT_EQ(left(), std::vector<std::string>(20, "frame"));
  for (int64_t n = 20; n < 25; ++n) EXPECT_EQ(push(n, 1), GST_FLOW_OK);
  EXPECT_TRUE(draining.get());
  std::vector<std::string> expected(25, "frame");
  expected.emplace_back("drain");
  EXPECT_EQ(left(), expected);
}

// The other's source may itself wait for the answer.
TEST_F(StageDrains, FailIfFramesOfAnotherFileDoNotCome) {
  use_performance();
  g_object_set(element_, "timeout", 0.2, nullptr);
  for (const unsigned number : {0U, 1U}) {
    gst_harness_set_live(camera(number), FALSE);
    start(number);
  }
  watch();
  push_all(-10, 20, 2);
  push_all(20, 25);
  EXPECT_FALSE(drain());
  for (int64_t n = 20; n < 25; ++n) EXPECT_EQ(push(n, 1), GST_FLOW_OK);
  EXPECT_EQ(pull(25).back().trigger, 24);
  EXPECT_EQ(left(), std::vector<std::string>(25, "frame"));
}

TEST_F(StageDrains, AFlushEndsTheWait) {
  use_performance();
  g_object_set(element_, "timeout", 60.0, nullptr);
  start(0);
  start(1);
  push_all(-10, 20, 2);
  push_all(20, 25);
  auto draining = std::async(std::launch::async, [&] { return drain(); });
  EXPECT_EQ(draining.wait_for(std::chrono::milliseconds(200)), std::future_status::timeout);
  flush(camera());
  EXPECT_FALSE(draining.get());
}

// Upstream drains to get its buffers back; the first frame of a pair has to wait for the second.
TEST_F(StageDrains, TheFirstOfAPairIsCopied) {
  use_performance();
  gst_util_set_object_arg(G_OBJECT(element_), "assemble", "pairs");
  start();
  push_all(-10, 13);
  const BallOnStage ball(program_, kWidth, kHeight);
  std::atomic<bool> returned{false};
  GstBuffer* first = buffer_of(ball.draw(13), 13);
  gst_mini_object_weak_ref(
      GST_MINI_OBJECT_CAST(first),
      [](gpointer flag, GstMiniObject*) { *static_cast<std::atomic<bool>*>(flag) = true; },
      &returned);
  ASSERT_EQ(gst_harness_push(camera(), first), GST_FLOW_OK);
  EXPECT_TRUE(drain());
  EXPECT_TRUE(returned);
  push_all(14, 20);
  const auto pairs = pull(8);
  EXPECT_EQ(pairs[5].trigger, 13);
  EXPECT_EQ(pairs[5].bytes[4 * (kWidth + kWidth / 2)], ball.draw(14)[4 * (kWidth / 2)]);
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
