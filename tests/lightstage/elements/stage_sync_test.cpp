// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync: labels, sets of several cameras, and what goes wrong.
#include <thread>

#include "stage_fixture.hpp"
#include "tests/elements/log_reader.hpp"

namespace inverse::testing {
namespace {

TEST_F(StageSync, FramesLeaveAsTheyCameWithTheirLabels) {
  start_performance();
  push_all(-10, 30);
  const auto frames = pull(30);
  for (size_t n = 0; n < frames.size(); ++n) {
    EXPECT_EQ(frames[n].trigger, static_cast<int64_t>(n));
    const int kind = n == 1  ? GST_LIGHT_STAGE_TRACKING
                     : n < 3 ? GST_LIGHT_STAGE_BLACK
                     : n % 2 ? GST_LIGHT_STAGE_GRADIENT_A
                             : GST_LIGHT_STAGE_GRADIENT_B;
    EXPECT_EQ(frames[n].kind, kind) << n;
    EXPECT_EQ(frames[n].step, n < 3 ? -1 : static_cast<int>((n - 3) % 2));
    EXPECT_EQ(frames[n].bytes,
              BallOnStage(program_, kWidth, kHeight).draw(static_cast<int64_t>(n)));
    const auto colors = program_.colors(program_.at(n));
    ASSERT_EQ(frames[n].colors.size(), 3 * colors.size());
    EXPECT_EQ(frames[n].colors[4], colors[1][1]);
  }
  EXPECT_EQ(count("labeled"), 30u);
  EXPECT_EQ(count("before-marker"), 10u);
  EXPECT_TRUE(errors().empty());
}

TEST_F(StageSync, LostFramesAreCountedAndReported) {
  start_performance();
  push_all(-10, 20);
  push_all(21, 31);
  push_all(32, 60);
  EXPECT_EQ(pull(58).back().trigger, 59);
  EXPECT_EQ(count("missing"), 2u);
  EXPECT_TRUE(warned_of("lost"));
}

/// Two cameras, each of which loses a frame.
class StageSets : public StageSync {
 protected:
  void push_sets() {
    push_all(-10, 20, 2);
    ASSERT_EQ(push(20, 1), GST_FLOW_OK);
    push_all(21, 25, 2);
    ASSERT_EQ(push(25, 0), GST_FLOW_OK);
    push_all(26, 40, 2);
  }
};

TEST_F(StageSets, LeaveWhereTheyAreComplete) {
  start_performance(2);
  push_sets();
  for (const unsigned number : {0u, 1u}) {
    const auto frames = pull(38, number);
    for (const Out& frame : frames) EXPECT_TRUE(frame.trigger != 20 && frame.trigger != 25);
    EXPECT_EQ(frames.back().trigger, 39);
  }
  EXPECT_EQ(count("sets-complete"), 38u);
  EXPECT_EQ(count("sets-incomplete"), 2u);
  EXPECT_EQ(count("incomplete"), 2u);
}

TEST_F(StageSets, AllPassWhereThatIsWanted) {
  gst_util_set_object_arg(G_OBJECT(element_), "sets", "all");
  start_performance(2);
  push_sets();
  EXPECT_EQ(pull(39, 0).back().trigger, 39);
  EXPECT_EQ(pull(39, 1).back().trigger, 39);
}

TEST_F(StageSync, ACameraThatLosesATrackingFrameIsWaitedFor) {
  use(static_capture(stage_lights(geodesic_directions(42)), 60));
  g_object_set(element_, "timeout", 0.1, nullptr);
  for (const unsigned number : {0u, 1u}) {
    start(number);
    gst_harness_set_live(camera(number), TRUE);
  }
  // At the rate of cameras: the labels of one wait for 23 frames, which take longer than `timeout`.
  for (int64_t n = -5; n < 52; ++n) {
    for (const unsigned number : {0u, 1u})
      if (number == 0 || n != 26) {
        ASSERT_EQ(push(n, number), GST_FLOW_OK);
      }
    g_usleep(1000000 / 60);
  }
  EXPECT_EQ(pull(50, 0).back().trigger, 50);  // a tracking frame
  EXPECT_EQ(count("incomplete"), 1u);         // that of the other camera
  EXPECT_EQ(count("sets-complete"), 50u);
  for (const std::string& text : warnings())
    EXPECT_EQ(text.find("have waited"), std::string::npos) << text;
}

TEST_F(StageSync, AStoppedCameraIsReportedAndTheOtherContinues) {
  g_object_set(element_, "timeout", 0.1, nullptr);
  gst_util_set_object_arg(G_OBJECT(element_), "sets", "all");
  start_performance(2);
  for (GstHarness* one : {camera(0), camera(1)}) gst_harness_set_live(one, TRUE);
  push_all(-10, 20, 2);
  pull(20, 1);
  push_all(20, 100);
  EXPECT_EQ(pull(100, 0).back().trigger, 99);
  EXPECT_TRUE(warned_of("sink_1"));
  // And comes back.
  push_all(100, 130, 2);
  EXPECT_EQ(pull(30, 1).back().trigger, 129);
  EXPECT_TRUE(errors().empty());
}

TEST_F(StageSync, ASingleStoppedCameraIsReportedAndMayResume) {
  start_performance();
  push_all(-10, 20);
  EXPECT_TRUE(warned_of("sink_0 has sent no frame"));
  push_all(200, 220);
  EXPECT_EQ(pull(40).back().trigger, 219);
  EXPECT_EQ(count("missing"), 180u);
}

TEST_F(StageSync, ACameraThatHasNotBegunIsGivenTimeAndOneThatHasIsNot) {
  use_performance();
  camera();  // plays
  g_usleep(3 * G_USEC_PER_SEC);
  EXPECT_TRUE(warnings().empty());
  start();
  EXPECT_TRUE(warned_of("sink_0 has sent no frame"));
}

TEST_F(StageSync, ACameraThatDoesNotStartBlocksNoOther) {
  gst_util_set_object_arg(G_OBJECT(element_), "sets", "all");
  start_performance();
  camera(1);
  const gint64 from = g_get_monotonic_time();
  push_all(-10, 60);
  EXPECT_EQ(pull(60).back().trigger, 59);
  EXPECT_LT(g_get_monotonic_time() - from, 25 * G_USEC_PER_SEC);  // not only after the report
  EXPECT_TRUE(warned_of("whose source has not begun"));
}

TEST_F(StageSync, AMarkerThatNeverComesIsAWarning) {
  g_object_set(element_, "tuning", "marker-timeout=0.5", nullptr);
  start_performance();
  push_all(-50, 0);
  EXPECT_TRUE(warned_of("marker"));
  EXPECT_EQ(gst_harness_buffers_in_queue(camera()), 0u);
}

TEST_F(StageSync, AMissingMarkerIsReportedBeforeTheEnd) {
  start_performance();
  push_all(-50, 0);
  std::string messages;
  gst_pad_add_probe(
      camera()->sinkpad, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM,
      [](GstPad*, GstPadProbeInfo* info, gpointer data) {
        auto& [bus, text] = *static_cast<std::pair<GstBus*, std::string*>*>(data);
        if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) != GST_EVENT_EOS)
          return GST_PAD_PROBE_OK;
        for (const std::string& warning : texts_of(bus, GST_MESSAGE_WARNING)) *text += warning;
        *text += " END";
        return GST_PAD_PROBE_OK;
      },
      new std::pair(bus_, &messages),
      [](gpointer data) { delete static_cast<std::pair<GstBus*, std::string*>*>(data); });
  ASSERT_TRUE(push_end());
  ASSERT_TRUE(ends());
  expect_contains(messages, "none of its frames has a label");
  EXPECT_LT(messages.find("none of its frames"), messages.find("END"));
}

TEST_F(StageSync, UnconfirmedSingleLightsAreAWarning) {
  LightProgram alone = static_capture(stage_lights(geodesic_directions(42)));
  std::erase_if(alone.steps, [](const LightStep& step) { return step.kind == StepKind::tracking; });
  use(alone);
  start();
  push_all(-5, 5);
  EXPECT_TRUE(warned_of("no tracking frame"));
}

TEST_F(StageSync, UnlabeledFramesMayPass) {
  g_object_set(element_, "tuning", "drop-unlabeled=false", nullptr);
  start_performance();
  push_all(-10, 10);
  const auto frames = pull(20);
  for (size_t n = 0; n < 20; ++n)
    EXPECT_EQ(frames[n].trigger, n < 10 ? -1 : static_cast<int64_t>(n) - 10);
}

TEST_F(StageSync, MissingAndInvalidProgramsAreErrors) {
  const auto fails = [&](const char* program, const char* expected) {
    g_object_set(element_, "program", program, nullptr);
    EXPECT_EQ(gst_element_set_state(element_, GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
    gst_element_set_state(element_, GST_STATE_NULL);
    expect_one(errors(), expected);
  };
  fails("/nowhere/program.json", "/nowhere/program.json");
  use_performance();
  g_file_set_contents(path_.c_str(), "{\"format\": 7", -1, nullptr);
  fails(path_.c_str(), "program.json");
  gst_util_set_object_arg(G_OBJECT(element_), "assemble", "pairs");
  fails("static:12:x", "static:12:x");
  gst_util_set_object_arg(G_OBJECT(element_), "assemble", "olat");
  fails("performance:12", "tracking");
}

TEST_F(StageSync, FlushSeekAndEos) {
  start_performance();
  push_all(-10, 20);
  pull(20);
  ASSERT_TRUE(gst_harness_push_event(camera(), gst_event_new_flush_start()));
  EXPECT_EQ(push(20), GST_FLOW_FLUSHING);
  flush(camera());
  push_all(5, 15);
  const auto again = pull(10);
  EXPECT_EQ(again.front().trigger, 5);
  ASSERT_TRUE(push_end());
  EXPECT_EQ(push(16), GST_FLOW_EOS);
  EXPECT_TRUE(ends());
}

TEST_F(StageSync, FrameIdsCount) {
  gst_util_set_object_arg(G_OBJECT(element_), "frame-id", "offset");
  g_object_set(element_, "tuning", "frame-id-bits=16", nullptr);
  start_performance();
  const BallOnStage ball(program_, kWidth, kHeight);
  for (int64_t n = -10; n < 300; ++n) {
    if (n % 50 == 49) continue;
    // Time stamps that wander by a third of a period.
    GstBuffer* buffer = buffer_of(
        ball.draw(n), static_cast<double>(n) + 0.33 * std::sin(static_cast<double>(3 * n)));
    GST_BUFFER_OFFSET(buffer) = static_cast<guint64>(65400 + n) % 65536;
    ASSERT_EQ(gst_harness_push(camera(), buffer), GST_FLOW_OK);
  }
  EXPECT_EQ(pull(294).back().trigger, 298);
  EXPECT_EQ(count("missing"), 5u);
}

TEST_F(StageSync, AnyFormatIsMeasuredAndSizesChange) {
  start_performance();
  push_all(-10, 10);
  const BallOnStage small(program_, 17, 11);
  start(0, caps(17, 11));
  push_all(small, 10, 30);
  const auto frames = pull(30);
  EXPECT_EQ(frames.back().trigger, 29);
  EXPECT_EQ(frames.back().bytes.size(), 17u * 11 * 4);
  for (const char* format : {"BGRA", "RGBx", "BGRx", "RGB", "BGR", "I420", "NV12", "YUY2", "UYVY",
                             "GRAY8", "GRAY16_LE", "P010_10LE", "I420_10LE", "RGBA64_LE"}) {
    const std::string odd = VideoHarness::caps(format, 13, 9);
    start(0, odd);
    EXPECT_EQ(push(random_frame(odd, 1), 40), GST_FLOW_OK) << format;
  }
  EXPECT_TRUE(errors().empty());
}

TEST_F(StageSync, ABufferThatIsTooSmallIsOneError) {
  start_performance();
  EXPECT_EQ(push(std::vector<uint8_t>(100), 0), GST_FLOW_ERROR);
  expect_one(errors(), "100 bytes");
}

TEST_F(StageSync, OnlyAKnownRateOtherThanTheProgramsIsAWarning) {
  use_performance();
  start(0, caps(kWidth, kHeight, "0/1"));
  EXPECT_TRUE(warnings().empty());
  start(0, caps(kWidth, kHeight, "25/1"));
  EXPECT_TRUE(warned_of("25"));
}

TEST_F(StageSync, ProgramsThatAreNoFilesHaveTheRateThatIsSet) {
  g_object_set(element_, "program", "performance:42", "rate", 25u, nullptr);
  start(0, caps(kWidth, kHeight, "25/1"));
  EXPECT_TRUE(warnings().empty());
  start(0, caps(kWidth, kHeight, "60/1"));
  EXPECT_TRUE(warned_of("property \"rate\""));
}

TEST_F(StageSync, FilesHaveARateOfTheirOwn) {
  use_performance();
  g_object_set(element_, "rate", 25u, nullptr);
  start(0, caps(kWidth, kHeight, "60/1"));
  EXPECT_TRUE(warnings().empty());
  start(0, caps(kWidth, kHeight, "25/1"));
  EXPECT_TRUE(warned_of("\"rate\" in " + path_));
}

TEST_F(StageSync, LatencyIsReportedForSeveralCameras) {
  g_object_set(element_, "timeout", 0.3, nullptr);
  start_performance(2);
  gst_harness_set_upstream_latency(camera(0), 20 * GST_MSECOND);
  gst_harness_set_upstream_latency(camera(1), 30 * GST_MSECOND);
  EXPECT_EQ(gst_harness_query_latency(camera(0)), 330 * GST_MSECOND);
}

TEST_F(StageSync, ThatACameraComesOrGoesChangesTheLatency) {
  start_performance();
  const auto posted = [&] {
    GstMessage* message = gst_bus_pop_filtered(bus_, GST_MESSAGE_LATENCY);
    if (message) gst_message_unref(message);
    return message != nullptr;
  };
  while (posted()) continue;
  GstPad* pad = gst_element_request_pad_simple(element_, "sink_7");
  ASSERT_NE(pad, nullptr);
  EXPECT_TRUE(posted());
  gst_element_release_request_pad(element_, pad);
  gst_object_unref(pad);
  EXPECT_TRUE(posted());
}

TEST_F(StageSync, LatencyHasTheTimeThatSingleLightsWaitToBeConfirmed) {
  use(static_capture(stage_lights(geodesic_directions(42))));
  start(0);
  gst_harness_set_upstream_latency(camera(0), 20 * GST_MSECOND);
  const GstClockTime period = GST_SECOND / 60 + 1;
  EXPECT_EQ(gst_harness_query_latency(camera(0)), 20 * GST_MSECOND + 23 * period);
}

TEST_F(StageSync, PadsComeAndGo) {
  start_performance(2);
  push_all(-10, 10, 2);
  pull(10, 0);
  GstPad* gone = gst_element_get_static_pad(element_, "sink_1");
  gst_harness_teardown(cameras_[1]);
  cameras_.erase(1);
  if (gone) {
    if (GST_OBJECT_PARENT(gone)) gst_element_release_request_pad(element_, gone);
    gst_object_unref(gone);
  }
  EXPECT_EQ(gst_element_get_static_pad(element_, "src_1"), nullptr);
  gst_element_set_state(element_, GST_STATE_PLAYING);
  push_all(10, 20);
  EXPECT_EQ(pull(10, 0).back().trigger, 19);
}

}  // namespace
}  // namespace inverse::testing
