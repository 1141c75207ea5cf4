// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions of globalintrinsicthesis that are clicked or proposed, while other things happen.
#include <algorithm>
#include <cmath>
#include <thread>

#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

/// A red wall and a gray floor with a shade before the wall, in which there is only its light;
/// RGBA, 96 x 72.
std::vector<uint8_t> shaded_floor(bool shade = true) {
  return draw(96, 72, [shade](int x, int y, int c) {
    const bool wall = x < 30, inside = shade && x >= 34 && x < 50 && y >= 20 && y < 50;
    const double red[] = {1, 0.25, 0.2};
    const double light = (wall ? red[c] : 0.9) * ((inside ? 0.01 : 0.5) + 0.15 * red[c]);
    return 255 * std::pow(std::min(light, 1.0), 1 / 2.2) + 0.5;
  });
}

class Regions : public ::testing::Test {
 protected:
  void mark(int x, int y) { g_signal_emit_by_name(element_, "mark", x, y); }
  void unmark(int region) { g_signal_emit_by_name(element_, "unmark", region); }
  void propose(const char* mode) { gst_util_set_object_arg(G_OBJECT(element_), "propose", mode); }
  guint count(const char* name) { return stat<guint>(element_, name); }
  bool reused() { return stat<bool>(element_, "reused"); }
  void play(const std::vector<uint8_t>& frame, int count) {
    for (int k = 0; k < count; ++k) ASSERT_EQ(harness_.process(frame).size(), frame.size());
  }
  /// Regions in these messages, since the last call.
  std::vector<int> regions(const std::string& name) {
    std::vector<int> result;
    for (const Structure& message : element_messages(harness_.bus(), name))
      result.push_back(field<int>(message.get(), "region").value_or(0));
    return result;
  }
  /// Reasons for which regions were lost, since the last call.
  std::vector<std::string> losses() {
    std::vector<std::string> result;
    for (const Structure& message : element_messages(harness_.bus(), "inverse-region-lost"))
      result.push_back(field<std::string>(message.get(), "reason").value_or(""));
    return result;
  }

  const std::string caps_ = VideoHarness::caps("RGBA", 96, 72);
  const std::vector<uint8_t> frame_ = shaded_floor();
  VideoHarness harness_{
      "globalintrinsicthesis tuning=steps=2:keyframes=0:refine-rounds=0", caps_, {}};
  GstElement* element_ = harness_.find("globalintrinsicthesis");
};

using Reasons = std::vector<std::string>;

TEST_F(Regions, AreProposedOnceAndOnlyReported) {
  play(frame_, 5);
  EXPECT_TRUE(regions("inverse-region-proposed").empty());
  propose("report");
  play(frame_, 40);
  EXPECT_EQ(regions("inverse-region-proposed"), std::vector{0});
  EXPECT_EQ(count("regions-proposed"), 1U);
  EXPECT_EQ(count("regions"), 0U);
  EXPECT_TRUE(reused()) << "nothing is left to be found in this picture";
}

TEST_F(Regions, AreProposedAndCorrected) {
  propose("correct");
  play(frame_, 40);
  EXPECT_EQ(regions("inverse-region-proposed"), std::vector{1});
  EXPECT_EQ(count("regions"), 1U);
  EXPECT_EQ(count("regions-decided"), 1U);
  // Its reflectance is the floor's, but for 22 code values: light differs by 94 to 126.
  const std::vector<uint8_t> shown = harness_.process(frame_);
  const auto at = [&](size_t x, size_t y) { return &shown[4 * (y * 96 + x)]; };
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(at(42, 35)[c], at(70, 35)[c], 24) << c;
  // The proposal is rejected.
  unmark(1);
  play(frame_, 40);
  EXPECT_EQ(losses(), Reasons{"unmarked"});
  EXPECT_EQ(count("regions"), 0U);
  harness_.flush();
  play(frame_, 40);
  EXPECT_EQ(count("regions"), 1U) << "a seek forgets the refusal";
}

TEST_F(Regions, ThatWereProposedGoWithTheMode) {
  for (const char* mode : {"off", "report"}) {
    propose("correct");
    play(frame_, 40);
    ASSERT_EQ(count("regions"), 1U);
    losses();
    propose(mode);  // while the picture stays
    play(frame_, 8);
    EXPECT_EQ(losses(), Reasons{"withdrawn"}) << mode;
    EXPECT_EQ(count("regions"), 0U) << mode;
  }
}

TEST_F(Regions, HundredsOfClicksAtOnceFromOtherThreads) {
  propose("correct");
  play(frame_, 20);
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int k = 0; k < 200; ++k) {
        mark((k * 7 + t) % 100 - 2, (k * 5) % 76 - 2);
        if (k % 3 == 0) unmark(k % 20 - 2);
      }
    });
  play(frame_, 10);
  for (std::thread& thread : threads) thread.join();
  play(frame_, 20);
  EXPECT_LE(count("regions"), 15U);
  EXPECT_FALSE(regions("inverse-region-marked").empty());
  for (int k = 1; k <= 15; ++k) unmark(k);
  play(frame_, 5);
  EXPECT_EQ(count("regions"), 0U);
}

TEST_F(Regions, UnmarkWhileTheCorrectionRuns) {
  play(frame_, 3);
  for (int waited = 0; waited < 6; ++waited) {
    mark(42, 35);
    play(frame_, 1 + waited);
    unmark(1);
    play(frame_, 6);
    EXPECT_EQ(count("regions"), 0U) << "unmarked after " << waited << " frames";
  }
  // The next one is decided all the same.
  regions("inverse-region-corrected");
  mark(42, 35);
  size_t corrected = 0;
  for (int k = 0; k < 40 && corrected == 0; ++k) {
    play(frame_, 1);
    corrected = regions("inverse-region-corrected").size();
  }
  EXPECT_EQ(corrected, 1U);
}

TEST_F(Regions, AreMarkedByAProperty) {
  g_object_set(element_, "marks", " 42,35  20,5 ", nullptr);
  play(frame_, 3);
  EXPECT_EQ(regions("inverse-region-marked").size(), 2U) << "in the first frame, once";
  g_object_set(element_, "marks", "39,29", nullptr);
  play(frame_, 3);
  EXPECT_EQ(regions("inverse-region-marked").size(), 1U);
  // Invalid marks are ignored and reported.
  for (const char* text : {"1", "1,2,3", "1,2 x", "a,b", "1 ,2", "10,10;20,20"}) {
    g_object_set(element_, "marks", text, nullptr);
    play(frame_, 1);
    expect_contains(next_text(harness_.bus(), GST_MESSAGE_WARNING, 0), "x,y");
    EXPECT_TRUE(regions("inverse-region-marked").empty()) << text;
  }
  g_object_set(element_, "marks", "", nullptr);
  play(frame_, 1);
  EXPECT_TRUE(harness_.warnings().empty());
}

TEST_F(Regions, CapsChangeAndFlushWhileTheCorrectionRuns) {
  propose("correct");
  for (int round = 0; round < 3; ++round) {
    play(frame_, 2);
    mark(42, 35);
    mark(20, 5);
    play(frame_, 2 + round);
    if (round == 1) harness_.flush();
    const std::string other = VideoHarness::caps("RGBA", 40 + 8 * round, 30);
    harness_.set_src_caps(other);
    const std::vector<uint8_t> small = random_frame(other, 3);
    mark(39, 29);
    for (int k = 0; k < 4; ++k) EXPECT_EQ(harness_.process(small).size(), small.size());
    harness_.set_src_caps(caps_);
  }
  play(frame_, 30);
  EXPECT_EQ(count("regions-proposed"), 1U);
  EXPECT_GE(std::ranges::count(losses(), "reset"), 3);
}

TEST_F(Regions, AVanishedRegionIsReported) {
  play(frame_, 3);
  mark(42, 35);
  play(frame_, 30);
  ASSERT_EQ(count("regions"), 1U);
  losses();
  play(shaded_floor(false), 5);
  EXPECT_EQ(count("regions"), 0U);
  EXPECT_EQ(losses(), Reasons{"lost"});
}

}  // namespace
}  // namespace inverse::testing
