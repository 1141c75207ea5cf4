// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync in front of sinks that keep to the latency: frames wait there, cameras do not.
#include <chrono>
#include <future>

#include "stage_fixture.hpp"

namespace inverse::testing {
namespace {

/// Sinks that hold the first frame, as one that waits for its time does, until they are let go.
class StageSinks : public StageSync {
 protected:
  void hold(unsigned number = 0) {
    GstPad* pad = camera(number)->sinkpad;
    const auto stay = [](GstPad*, GstPadProbeInfo*, gpointer) { return GST_PAD_PROBE_OK; };
    const auto type =
        static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BLOCK | GST_PAD_PROBE_TYPE_BUFFER);
    held_[pad] = gst_pad_add_probe(pad, type, stay, nullptr, nullptr);
  }
  void let_go() {
    for (const auto& [pad, probe] : held_) gst_pad_remove_probe(pad, probe);
    held_.clear();
  }
  /// Whether cameras can send these frames while sinks wait.
  bool all_sent(int64_t from, int64_t to, unsigned cameras = 1) {
    auto sent = std::async(std::launch::async, [&] {
      for (int64_t n = from; n < to; ++n)
        for (unsigned number = 0; number < cameras; ++number) push(n, number);
    });
    const bool done = sent.wait_for(std::chrono::seconds(30)) == std::future_status::ready;
    let_go();
    return done;
  }

  std::map<GstPad*, gulong> held_;
};

TEST_F(StageSinks, WaitForSetsAndBlockNoCamera) {
  use_performance();
  g_object_set(element_, "timeout", 0.5, nullptr);
  for (const unsigned number : {0u, 1u}) {
    start(number);
    gst_harness_set_live(camera(number), TRUE);
    hold(number);
  }
  EXPECT_TRUE(all_sent(-10, 30, 2));
  for (const unsigned number : {0u, 1u}) EXPECT_EQ(pull(30, number).back().trigger, 29);
}

TEST_F(StageSinks, WaitForConfirmationAndBlockNoCamera) {
  use(static_capture(stage_lights(geodesic_directions(42)), 60));
  start();
  gst_harness_set_live(camera(), TRUE);
  hold();
  EXPECT_TRUE(all_sent(-5, 39));  // those up to 38, a tracking frame, go out
  EXPECT_EQ(pull(39).back().trigger, 38);
}

TEST_F(StageSinks, WaitForOtherBranchesAndBlockNoCamera) {
  start_performance();
  hold();
  gst_harness_push_upstream_event(camera(), gst_event_new_latency(GST_SECOND));
  EXPECT_TRUE(all_sent(-10, 60));
  EXPECT_EQ(pull(60).back().trigger, 59);
}

TEST_F(StageSinks, ThatDoNotWaitHaveAFewFramesInLine) {
  start_performance();
  gst_harness_set_live(camera(), FALSE);
  hold();
  auto sent = std::async(std::launch::async, [&] {
    for (int64_t n = -10; n < 40; ++n) push(n);
  });
  EXPECT_EQ(sent.wait_for(std::chrono::milliseconds(500)), std::future_status::timeout);
  let_go();
  sent.wait();
  EXPECT_EQ(pull(40).back().trigger, 39);
}

}  // namespace
}  // namespace inverse::testing
