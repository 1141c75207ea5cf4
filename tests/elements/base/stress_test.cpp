// SPDX-License-Identifier: LGPL-2.1-or-later
// 10 000 operations of each kind that several threads do at once: nothing is lost, nothing hangs,
// no frame goes out after an error. Built with a sanitizer it tells of races.
#include <atomic>
#include <thread>

#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

constexpr int kOperations = 10000;

/// Runs `act` in a thread until it is destroyed.
class Meanwhile {
 public:
  explicit Meanwhile(std::function<void()> act)
      : thread_([this, act = std::move(act)] {
          while (!over_) act();
        }) {}
  ~Meanwhile() {
    over_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> over_{false};
  std::thread thread_;
};

class Stress : public ::testing::TestWithParam<const char*> {};

TEST_P(Stress, QueriesAreAnsweredWhileFlushesAndDrainsCome) {
  const std::string caps = VideoHarness::caps("RGBA", 32, 24);
  VideoHarness harness(GetParam(), caps, caps);
  gst_harness_set_drop_buffers(harness.harness(), TRUE);
  const auto frame = random_frame(caps, 1);
  harness.push(frame);
  std::atomic<int> answered{0};
  {
    GstPad* src = harness.harness()->srcpad;
    GstPad* sink = harness.harness()->sinkpad;
    const Meanwhile drains([&] {
      GstQuery* query = gst_query_new_drain();
      gst_pad_peer_query(src, query);
      gst_query_unref(query);
      ++answered;
    });
    const Meanwhile latencies([&] {
      GstQuery* query = gst_query_new_latency();
      gst_pad_peer_query(sink, query);
      gst_query_unref(query);
      ++answered;
    });
    std::mt19937 random(7);
    for (int i = 0; i < kOperations || answered < kOperations; ++i) {
      if (random() % 8 == 0)
        harness.flush();
      else if (random() % 32 == 0)
        EXPECT_EQ(harness.push(frame), GST_FLOW_OK) << i;
      else
        harness.send_upstream(gst_event_new_reconfigure());
    }
  }
  gst_harness_set_drop_buffers(harness.harness(), FALSE);
  EXPECT_FALSE(harness.process(frame).empty());
  EXPECT_TRUE(harness.errors().empty());
}

TEST_P(Stress, CapsChangeUnderLoad) {
  const std::string caps[] = {VideoHarness::caps("RGBA", 32, 24),
                              VideoHarness::caps("NV12", 32, 24),
                              VideoHarness::caps("RGBA", 24, 40)};
  VideoHarness harness(GetParam(), caps[0]);
  gst_harness_set_drop_buffers(harness.harness(), TRUE);
  size_t at = 0;
  {
    GstElement* element = harness.find(GetParam());
    const Meanwhile properties([&] {
      property<double>(element, "target-fps");
      find_stat<double>(element, "device-ms");
    });
    std::mt19937 random(9);
    for (int i = 0; i < kOperations; ++i) {
      if (random() % 100 == 0) harness.set_src_caps(caps[at = random() % 3]);
      if (random() % 4 == 0)
        EXPECT_EQ(harness.push(flat_frame(caps[at], static_cast<uint8_t>(i))), GST_FLOW_OK) << i;
      else
        harness.send_upstream(gst_event_new_reconfigure());
    }
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST_P(Stress, StrokesOfSeveralThreadsWhileFramesComplete) {
  const std::string caps = VideoHarness::caps("RGBA", 32, 24);
  VideoHarness harness(GetParam(), caps, caps);
  gst_harness_set_drop_buffers(harness.harness(), TRUE);
  GstElement* element = harness.find(GetParam());
  const auto call = [&](const char* signal, const char* stroke) {
    gboolean done = FALSE;
    if (stroke)
      g_signal_emit_by_name(element, signal, stroke, &done);
    else
      g_signal_emit_by_name(element, signal, &done);
    return done != FALSE;
  };
  const auto frame = random_frame(caps, 1);
  std::atomic<int> there{0};
  {
    const Meanwhile frames([&] { harness.push(frame); });
    std::vector<std::thread> threads;
    for (int k = 0; k < 3; ++k)
      threads.emplace_back([&, k] {
        std::mt19937 random{static_cast<unsigned>(k)};
        for (int i = 0; i < kOperations / 3; ++i) {
          if (random() % 2)
            there += call("add-stroke", R"({"kind":"shading","points":[[5,5]]})");
          else
            there -= call("undo-stroke", nullptr);
        }
      });
    for (std::thread& thread : threads) thread.join();
  }
  const std::string strokes = property<std::string>(element, "strokes::list");
  int count = 0;
  for (size_t place = 0; (place = strokes.find("points", place)) != std::string::npos; ++place)
    ++count;
  EXPECT_EQ(count, there) << strokes;
  EXPECT_TRUE(harness.errors().empty());
}

INSTANTIATE_TEST_SUITE_P(All, Stress, ::testing::Values("intrinsicdecomp", "globalintrinsic"));

}  // namespace
}  // namespace inverse::testing
