// SPDX-License-Identifier: LGPL-2.1-or-later
// target-fps and latency-budget: the work for a frame follows what it may take.
#include <chrono>

#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

constexpr guint kTop = 3;  // of quality=low

/// What `stats` of intrinsicdecomp says of the trade; `on` false if it says nothing.
struct Live {
  bool on = false;
  guint level = 0, cycles = 0;
  guint64 moves = 0;
  double budget = 0, predicted = 0;
  std::string reason;
};

Live live_of(VideoHarness& harness) {
  GstElement* element = harness.find("intrinsicdecomp");
  Live live;
  live.cycles = find_stat<guint>(element, "cycles").value_or(0);
  live.on = find_stat<guint>(element, "quality-level").has_value();
  if (!live.on) return live;
  live.level = stat<guint>(element, "quality-level");
  live.moves = stat<guint64>(element, "level-changes");
  live.budget = stat<double>(element, "frame-budget-ms");
  live.predicted = stat<double>(element, "frame-predicted-ms");
  live.reason = stat<std::string>(element, "level-reason");
  return live;
}

std::string caps_of(int width, int height) { return VideoHarness::caps("RGBA", width, height); }

/// Frames that differ, over and over.
class Source {
 public:
  explicit Source(const std::string& caps) {
    for (unsigned i = 0; i < 3; ++i) frames_.push_back(random_frame(caps, i));
  }
  const std::vector<uint8_t>& next() { return frames_[count_++ % frames_.size()]; }

 private:
  std::vector<std::vector<uint8_t>> frames_;
  size_t count_ = 0;
};

/// Sends frames until `reached`, at most a minute; every one has to come out.
template <typename Reached>
Live send_until(VideoHarness& harness, Source& source, Reached reached,
                const std::function<void()>& after = {}) {
  const auto start = std::chrono::steady_clock::now();
  Live live;
  do {
    EXPECT_FALSE(harness.process(source.next()).empty());
    if (after) after();
    live = live_of(harness);
    if (reached(live)) return live;
  } while (std::chrono::steady_clock::now() - start < std::chrono::minutes(1));
  ADD_FAILURE() << "stays at level " << live.level << " of " << live.predicted << " ms, budget "
                << live.budget << " ms: " << live.reason;
  return live;
}

void set(VideoHarness& harness, const char* property, double value) {
  g_object_set(harness.find("intrinsicdecomp"), property, value, nullptr);
}

}  // namespace

TEST(Live, WithoutAGoalThereIsNoTrade) {
  const std::string caps = caps_of(64, 48);
  VideoHarness harness("intrinsicdecomp quality=low", caps, caps);
  Source source(caps);
  for (int i = 0; i < 8; ++i) harness.process(source.next());
  EXPECT_FALSE(live_of(harness).on);
  EXPECT_EQ(live_of(harness).cycles, 2u);
}

TEST(Live, WorkFollowsTheBudgetDownAndUp) {
  const std::string caps = caps_of(64, 48);
  VideoHarness harness("intrinsicdecomp quality=low target-fps=1000 latency-budget=0.01", caps,
                       caps);
  Source source(caps);
  Live live = send_until(harness, source, [](const Live& l) { return l.on && l.level == 0; });
  EXPECT_DOUBLE_EQ(live.budget, 0.01);
  EXPECT_EQ(live.reason.rfind("down: took ", 0), 0u) << live.reason;
  for (int i = 0; i < 8; ++i) harness.process(source.next());
  EXPECT_EQ(live_of(harness).level, 0u) << "slow as it is, frames come out";
  EXPECT_EQ(live_of(harness).cycles, 1u);
  set(harness, "latency-budget", 0);
  set(harness, "target-fps", 0.001);
  live = send_until(harness, source, [](const Live& l) { return l.level == kTop; });
  EXPECT_EQ(live.reason.rfind("up: expects ", 0), 0u) << live.reason;
  EXPECT_EQ(live.cycles, 2u);
  EXPECT_GT(live.predicted, 0);
  set(harness, "target-fps", 0);
  harness.process(source.next());
  EXPECT_FALSE(live_of(harness).on);
}

TEST(Live, WhatIsSetExplicitlyStays) {
  const std::string caps = caps_of(64, 48);
  VideoHarness harness("intrinsicdecomp quality=low latency-budget=0.01 tuning=warm-cycles=3", caps,
                       caps);
  Source source(caps);
  send_until(harness, source, [](const Live& l) { return l.on && l.level == 0; });
  harness.process(source.next());
  EXPECT_EQ(live_of(harness).cycles, 3u);
  EXPECT_EQ(property<std::string>(harness.find("intrinsicdecomp"), "tuning"), "warm-cycles=3")
      << "properties show what was set, not what is done";
}

// The artificial load is the frame: two hundred times as many pixels.
TEST(Live, QualityFallsUnderLoadAndReturnsAfterIt) {
  VideoHarness harness("intrinsicdecomp quality=low latency-budget=100000", caps_of(48, 32));
  Source light(caps_of(48, 32)), heavy(caps_of(640, 480));
  double usual = 0;
  for (int i = 0; i < 20; ++i) {
    harness.process(light.next());
    usual = std::max(usual, live_of(harness).predicted);
  }
  ASSERT_GT(usual, 0);
  ASSERT_EQ(live_of(harness).level, kTop);
  // What the light frames take with room to spare and the heavy ones cannot, at any level.
  set(harness, "latency-budget", 2 * usual);
  harness.set_src_caps(caps_of(640, 480));
  send_until(harness, heavy, [](const Live& l) { return l.level < kTop; });
  set(harness, "latency-budget", 100 * usual);
  harness.set_src_caps(caps_of(48, 32));
  const Live live = send_until(harness, light, [](const Live& l) { return l.level == kTop; });
  EXPECT_EQ(live.reason.rfind("up: ", 0), 0u);
}

TEST(Live, LatenessDownstreamLowersQuality) {
  const std::string caps = caps_of(64, 48);
  VideoHarness harness("intrinsicdecomp quality=low target-fps=0.001", caps, caps);
  Source source(caps);
  GstClockTime time = 0;
  // A sink that was a millisecond late, or early by five: too little to drop a frame for.
  const auto report = [&](GstClockTimeDiff late) {
    harness.send_upstream(gst_event_new_qos(
        late > 0 ? GST_QOS_TYPE_UNDERFLOW : GST_QOS_TYPE_OVERFLOW, 1.0, late, time));
    time += GST_SECOND / 25;
  };
  Live live = send_until(
      harness, source, [](const Live& l) { return l.level == 0; }, [&] { report(GST_MSECOND); });
  EXPECT_EQ(live.reason, "down: 1.0 ms late downstream");
  live = send_until(
      harness, source, [](const Live& l) { return l.level == kTop; },
      [&] { report(-5 * static_cast<GstClockTimeDiff>(GST_MSECOND)); });
  EXPECT_EQ(live.reason.rfind("up: ", 0), 0u);
}

TEST(Live, FramesAreDroppedAtTheLowestQuality) {
  const std::string caps = caps_of(64, 48);
  VideoHarness harness("intrinsicdecomp quality=low target-fps=1000", caps, caps);
  Source source(caps);
  harness.process(source.next());  // at 0
  harness.send_upstream(
      gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 2.0, 100 * GST_MSECOND, 10 * GST_MSECOND));
  // GstBaseTransform drops what is due before 110 ms.
  for (int i = 1; i < 5; ++i) EXPECT_EQ(harness.push(source.next()), GST_FLOW_OK);
  EXPECT_EQ(gst_harness_buffers_received(harness.harness()), 3u);
}

}  // namespace inverse::testing
