// SPDX-License-Identifier: LGPL-2.1-or-later
// Pictures of layers that come back to intrinsiccompose and intrinsicmerge: which frame they belong
// to, and what happens to a frame without one.
#include <chrono>
#include <thread>

#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/elements/layer_of.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 40, kHeight = 30;
constexpr GstClockTime kFrame = GST_SECOND / 25;

/// intrinsiccompose with pad `shading`, fed by hand with layers and pictures.
class ReturnedPads : public ::testing::Test {
 protected:
  void SetUp() override {
    GstElement* element = gst_element_factory_make("intrinsiccompose", nullptr);
    compose_ = gst_harness_new_with_element(element, "sink", "src");
    gst_object_unref(element);
    gst_element_set_bus(element, bus_);
    branch_ = gst_harness_new_with_element(element, "shading", nullptr);
    gst_harness_set_sink_caps_str(compose_, caps_.c_str());
    set_branch_caps(caps_);
    set_latencies(0, 20 * GST_SECOND);  // as if the effect took that long
  }
  void TearDown() override {
    gst_element_set_bus(compose_->element, nullptr);
    gst_harness_teardown(branch_);
    gst_harness_teardown(compose_);
    gst_object_unref(bus_);
  }
  GstElement* element() { return compose_->element; }
  void set_latencies(GstClockTime main, GstClockTime branch) {
    gst_harness_set_upstream_latency(compose_, main);
    gst_harness_set_upstream_latency(branch_, branch);
  }
  void set_branch_caps(const std::string& caps) {
    gst_harness_set_src_caps_str(branch_, caps.c_str());
  }

  /// Layers of the same frame each time, at frame number `n`; returns the flow.
  GstFlowReturn push_layers(int n) {
    Buffer buffer = decomposer_.process_buffer(frame_);
    if (!sent_caps_) {
      gst_harness_set_src_caps_str(compose_, caps_out_of(decomposer_.harness()).c_str());
      sent_caps_ = true;
    }
    GST_BUFFER_PTS(buffer.get()) = static_cast<GstClockTime>(n) * kFrame;
    GST_BUFFER_DURATION(buffer.get()) = kFrame;
    return gst_harness_push(compose_, buffer.release());
  }
  /// A picture all of one value.
  GstFlowReturn push_picture(GstClockTime time, uint8_t value, const std::string& caps = {}) {
    const auto bytes = flat_frame(caps.empty() ? caps_ : caps, value);
    GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
    GST_BUFFER_PTS(buffer) = time;
    return gst_harness_push(branch_, buffer);
  }
  std::vector<uint8_t> pull() {
    const Buffer buffer(gst_harness_try_pull(compose_));
    return buffer ? bytes_of(buffer.get()) : std::vector<uint8_t>{};
  }
  /// What comes out for layers pushed now.
  std::vector<uint8_t> compose(int n) {
    EXPECT_EQ(push_layers(n), GST_FLOW_OK);
    return pull();
  }
  /// Black where shading came back black.
  bool edited(const std::vector<uint8_t>& frame) {
    const auto seen = visible(caps_, frame);
    for (size_t i = 0; i < seen.size(); ++i)
      if (i % 4 != 3 && seen[i] > 0) return false;
    return !seen.empty();
  }
  bool unedited(const std::vector<uint8_t>& frame) { return frame == frame_; }
  guint64 missing() { return stat<guint64>(element(), "returned-missing"); }
  guint64 late() { return stat<guint64>(element(), "returned-late"); }

  const std::string caps_ = VideoHarness::caps("RGBA", kWidth, kHeight);
  const std::vector<uint8_t> frame_ =
      draw(kWidth, kHeight, [](int x, int y, int c) { return 60 + 2 * x + 3 * y + 7 * c; });
  VideoHarness decomposer_{"intrinsicdecomp", caps_, kLayers};
  GstBus* bus_ = gst_bus_new();
  GstHarness* compose_ = nullptr;
  GstHarness* branch_ = nullptr;
  bool sent_caps_ = false;
};

}  // namespace

TEST_F(ReturnedPads, APictureChangesTheFrameOfItsTime) {
  push_picture(0, 0);
  EXPECT_TRUE(edited(compose(0)));
  // Near enough: effects may round.
  push_picture(kFrame + kFrame / 4, 0);
  EXPECT_TRUE(edited(compose(1)));
  push_picture(3 * kFrame, 0);
  EXPECT_TRUE(unedited(compose(2)));  // that of a later frame says that there is none
  EXPECT_EQ(missing(), 1U);
  EXPECT_TRUE(edited(compose(3)));
  EXPECT_EQ(missing(), 1U);
  EXPECT_EQ(late(), 0U);
}

TEST_F(ReturnedPads, OldPicturesAreDroppedAndCounted) {
  push_picture(0, 0);
  push_picture(kFrame, 0);
  push_picture(3 * kFrame, 0);
  EXPECT_TRUE(edited(compose(3)));
  EXPECT_EQ(late(), 2U);
  EXPECT_EQ(missing(), 0U);
}

TEST_F(ReturnedPads, APictureWithoutATimeBelongsToTheNextFrame) {
  push_picture(GST_CLOCK_TIME_NONE, 0);
  EXPECT_TRUE(edited(compose(7)));
}

TEST_F(ReturnedPads, AFrameWaitsForItsPicture) {
  std::thread later([&] {
    g_usleep(200000);
    push_picture(0, 0);
  });
  EXPECT_TRUE(edited(compose(0)));
  later.join();
}

TEST_F(ReturnedPads, ABranchMayEndOrHaveAGapWithoutHoldingFramesUp) {
  gst_harness_push_event(branch_, gst_event_new_gap(0, 2 * kFrame));
  EXPECT_TRUE(unedited(compose(0)));
  EXPECT_TRUE(unedited(compose(1)));
  push_picture(2 * kFrame, 0);
  EXPECT_TRUE(edited(compose(2)));
  gst_harness_push_event(branch_, gst_event_new_eos());
  EXPECT_TRUE(unedited(compose(3)));
  EXPECT_EQ(missing(), 3U);
}

TEST_F(ReturnedPads, CapsMayChangeOnAPadAlone) {
  push_picture(0, 0);
  EXPECT_TRUE(edited(compose(0)));
  int n = 1;
  for (const auto& [format, width, height] :
       {std::tuple{"GRAY8", kWidth, kHeight}, {"RGB", 13, 7}, {"BGRx", 200, 160}, {"RGBA", 1, 1}}) {
    const std::string caps = VideoHarness::caps(format, width, height);
    set_branch_caps(caps);
    push_picture(static_cast<GstClockTime>(n) * kFrame, 0, caps);
    EXPECT_TRUE(edited(compose(n++))) << caps;
  }
  EXPECT_EQ(texts_of(bus_, GST_MESSAGE_ERROR).size(), 0U);
}

TEST_F(ReturnedPads, AFlushEndsTheWait) {
  std::thread flusher([&] {
    g_usleep(300000);
    gst_harness_push_event(compose_, gst_event_new_flush_start());
  });
  EXPECT_EQ(push_layers(0), GST_FLOW_FLUSHING);
  flusher.join();
  gst_harness_push_event(compose_, gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_harness_push_event(compose_, gst_event_new_segment(&segment));
  flush(branch_);
  push_picture(0, 0);
  EXPECT_TRUE(edited(compose(0)));
}

TEST_F(ReturnedPads, SoDoesAStop) {
  std::thread stopper([&] {
    g_usleep(300000);
    gst_element_set_state(element(), GST_STATE_READY);
  });
  EXPECT_EQ(push_layers(0), GST_FLOW_FLUSHING);
  stopper.join();
}

TEST_F(ReturnedPads, InALivePipelineFramesWaitNoLongerThanTheLatency) {
  set_latencies(0, 0);
  const auto start = std::chrono::steady_clock::now();
  for (int n = 0; n < 5; ++n) EXPECT_TRUE(unedited(compose(n)));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  EXPECT_EQ(missing(), 5U);
  // The branch may begin at any time.
  push_picture(5 * kFrame, 0);
  EXPECT_TRUE(edited(compose(5)));
  EXPECT_EQ(missing(), 5U);
}

TEST_F(ReturnedPads, LatencyIsTheMaximumOfTheBranches) {
  set_latencies(10 * GST_MSECOND, 70 * GST_MSECOND);
  push_picture(0, 0);
  EXPECT_TRUE(edited(compose(0)));
  // Its own share is a frame's duration.
  EXPECT_EQ(gst_harness_query_latency(compose_), 70 * GST_MSECOND + kFrame);
}

TEST_F(ReturnedPads, PicturesOfAnotherLayerAreRefused) {
  const std::string source =
      "videotestsrc num-buffers=2 ! " + VideoHarness::caps("RGBA", kWidth, kHeight) +
      " ! intrinsicdecomp ! tee name=t t. ! intrinsicsplit name=s s.reflectance ! c.shading "
      "t. ! queue ! intrinsiccompose name=c ! fakesink";
  expect_one(run_line(source).errors, "pad shading", "pictures of reflectance");
}

TEST_F(ReturnedPads, AMaskFromElsewhereSelects) {
  const std::string caps = VideoHarness::caps("RGBA", kWidth, kHeight),
                    left = "video/x-raw,format=GRAY8,width=20,height=30,framerate=25/1";
  const auto line = [&](const std::string& editor) {
    return "videotestsrc pattern=solid-color foreground-color=0xff808080 num-buffers=3 ! " + caps +
           " ! intrinsicdecomp ! intrinsicmerge name=m ! " + editor +
           " ! video/x-raw,format=RGBA ! appsink name=out sync=false compositor name=c "
           "background=black sink_0::xpos=0 ! video/x-raw,format=GRAY8,width=40,height=30 ! m.mask "
           "videotestsrc pattern=white num-buffers=3 ! " +
           left + " ! c.sink_0";
  };
  const auto shown = run_line(line("intrinsiccompose show=mask"));
  ASSERT_EQ(shown.frames.size(), 3U) << shown.first_error();
  const auto painted = run_line(line("intrinsicrecolor target=0xffff0000 ! intrinsiccompose"));
  ASSERT_EQ(painted.frames.size(), 3U) << painted.first_error();
  for (size_t n = 0; n < 3; ++n) {
    EXPECT_GT(pixel_at(shown.frames[n], 8, 15, kWidth)[0], 220) << n;
    EXPECT_LT(pixel_at(shown.frames[n], 32, 15, kWidth)[0], 5) << n;
    const uint8_t *red = pixel_at(painted.frames[n], 8, 15, kWidth),
                  *gray = pixel_at(painted.frames[n], 32, 15, kWidth);
    EXPECT_GT(red[0], red[1] + 60) << n;
    EXPECT_NEAR(gray[0], 0x80, 2) << n;
    EXPECT_NEAR(gray[1], 0x80, 2) << n;
  }
}

TEST_F(ReturnedPads, PadsComeAndGoAndThereIsOneOfALayer) {
  EXPECT_EQ(gst_element_request_pad_simple(element(), "shading"), nullptr);
  GstPad* pad = gst_element_request_pad_simple(element(), "reflectance");
  ASSERT_TRUE(pad);
  push_picture(0, 0);
  EXPECT_TRUE(edited(compose(0)));  // nothing is linked to the other one
  gst_element_release_request_pad(element(), pad);
  gst_object_unref(pad);
  push_picture(kFrame, 0);
  EXPECT_TRUE(edited(compose(1)));
}

}  // namespace inverse::testing
