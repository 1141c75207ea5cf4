// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions of globalintrinsicthesis that are clicked or proposed, while other things happen.
#include <cmath>
#include <thread>

#include "tests/elements/element_test.hpp"

namespace inverse::testing {
namespace {

struct Message {
  std::string name, reason;
  int region = 0;
  int color = -1;
};

/// A red wall and a gray floor with a shade before the wall, in which there is only its light;
/// RGBA, 96 x 72.
std::vector<uint8_t> shaded_floor(bool shade = true) {
  std::vector<uint8_t> frame(4 * 96 * 72, 255);
  const auto encode = [](double v) {
    return static_cast<uint8_t>(255 * std::pow(std::min(v, 1.0), 1 / 2.2) + 0.5);
  };
  for (size_t n = 0; n < 96 * 72; ++n) {
    const size_t x = n % 96, y = n / 96;
    const bool wall = x < 30, inside = shade && x >= 34 && x < 50 && y >= 20 && y < 50;
    const double red[] = {1, 0.25, 0.2};
    for (size_t c = 0; c < 3; ++c)
      frame[4 * n + c] = encode((wall ? red[c] : 0.9) * ((inside ? 0.01 : 0.5) + 0.15 * red[c]));
  }
  return frame;
}

class Regions : public ::testing::Test {
 protected:
  void SetUp() override {
    element_ = harness_.find("globalintrinsicthesis");
    gst_element_set_bus(element_, bus_);
  }
  void TearDown() override {
    gst_element_set_bus(element_, nullptr);
    gst_object_unref(bus_);
  }
  void mark(int x, int y) { g_signal_emit_by_name(element_, "mark", x, y); }
  void unmark(int region) { g_signal_emit_by_name(element_, "unmark", region); }
  void propose(const char* mode) { gst_util_set_object_arg(G_OBJECT(element_), "propose", mode); }
  guint count(const char* name) { return stat<guint>(element_, name); }
  bool reused() { return stat<bool>(element_, "reused"); }
  void play(const std::vector<uint8_t>& frame, int count) {
    for (int k = 0; k < count; ++k) ASSERT_EQ(harness_.process(frame).size(), frame.size());
  }
  /// These messages, since the last call.
  std::vector<Message> messages(const std::string& name) {
    std::vector<Message> result;
    for (const Structure& message : element_messages(bus_, name))
      result.push_back({name, field<std::string>(message.get(), "reason").value_or(""),
                        field<int>(message.get(), "region").value_or(0),
                        field<int>(message.get(), "color").value_or(-1)});
    return result;
  }

  const std::string caps_ = VideoHarness::caps("RGBA", 96, 72);
  const std::vector<uint8_t> frame_ = shaded_floor();
  VideoHarness harness_{
      "globalintrinsicthesis tuning=steps=2:keyframes=0:refine-rounds=0", caps_, {}};
  GstBus* bus_ = gst_bus_new();
  GstElement* element_ = nullptr;
};

TEST_F(Regions, AreProposedOnceAndOnlyReported) {
  play(frame_, 5);
  EXPECT_TRUE(messages("inverse-region-proposed").empty());
  propose("report");
  play(frame_, 40);
  const auto proposed = messages("inverse-region-proposed");
  ASSERT_EQ(proposed.size(), 1U);
  EXPECT_EQ(proposed[0].region, 0);
  EXPECT_EQ(count("regions-proposed"), 1U);
  EXPECT_EQ(count("regions"), 0U);
  EXPECT_TRUE(reused()) << "nothing is left to be found in this picture";
}

TEST_F(Regions, AreProposedAndCorrected) {
  propose("correct");
  play(frame_, 40);
  const auto proposed = messages("inverse-region-proposed");
  ASSERT_EQ(proposed.size(), 1U);
  EXPECT_EQ(proposed[0].region, 1);
  EXPECT_EQ(count("regions"), 1U);
  EXPECT_EQ(count("regions-decided"), 1U);
  // Its reflectance is the floor's, but for 22 code values: light differs by 94 to 126.
  const std::vector<uint8_t> shown = harness_.process(frame_);
  const auto at = [&](size_t x, size_t y) { return &shown[4 * (y * 96 + x)]; };
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(at(42, 35)[c], at(70, 35)[c], 24) << c;
  // The proposal is rejected.
  unmark(1);
  play(frame_, 40);
  const auto lost = messages("inverse-region-lost");
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0].reason, "unmarked");
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
    messages("inverse-region-lost");
    propose(mode);  // while the picture stays
    play(frame_, 8);
    const auto lost = messages("inverse-region-lost");
    ASSERT_EQ(lost.size(), 1U) << mode;
    EXPECT_EQ(lost[0].reason, "withdrawn") << mode;
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
  EXPECT_FALSE(messages("inverse-region-marked").empty());
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
  messages("inverse-region-corrected");
  mark(42, 35);
  size_t corrected = 0;
  for (int k = 0; k < 40 && corrected == 0; ++k) {
    play(frame_, 1);
    corrected = messages("inverse-region-corrected").size();
  }
  EXPECT_EQ(corrected, 1U);
}

TEST_F(Regions, AreMarkedByAProperty) {
  g_object_set(element_, "marks", " 42,35  20,5 ", nullptr);
  play(frame_, 3);
  EXPECT_EQ(messages("inverse-region-marked").size(), 2U) << "in the first frame, once";
  g_object_set(element_, "marks", "39,29", nullptr);
  play(frame_, 3);
  EXPECT_EQ(messages("inverse-region-marked").size(), 1U);
  // Invalid marks are ignored and reported.
  for (const char* text : {"1", "1,2,3", "1,2 x", "a,b", "1 ,2", "10,10;20,20"}) {
    g_object_set(element_, "marks", text, nullptr);
    play(frame_, 1);
    GstMessage* message = gst_bus_pop_filtered(bus_, GST_MESSAGE_WARNING);
    ASSERT_NE(message, nullptr) << text;
    GError* warning = nullptr;
    gst_message_parse_warning(message, &warning, nullptr);
    EXPECT_NE(std::string(warning->message).find("x,y"), std::string::npos) << warning->message;
    g_error_free(warning);
    gst_message_unref(message);
    EXPECT_TRUE(messages("inverse-region-marked").empty()) << text;
  }
  g_object_set(element_, "marks", "", nullptr);
  play(frame_, 1);
  EXPECT_EQ(gst_bus_pop_filtered(bus_, GST_MESSAGE_WARNING), nullptr);
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
  EXPECT_TRUE(harness_.errors().empty());
  play(frame_, 30);
  EXPECT_EQ(count("regions-proposed"), 1U);
  int reset = 0;
  for (const Message& lost : messages("inverse-region-lost")) reset += lost.reason == "reset";
  EXPECT_GE(reset, 3);
}

TEST_F(Regions, AVanishedRegionIsReported) {
  play(frame_, 3);
  mark(42, 35);
  play(frame_, 30);
  ASSERT_EQ(count("regions"), 1U);
  messages("inverse-region-lost");
  play(shaded_floor(false), 5);
  EXPECT_EQ(count("regions"), 0U);
  const auto lost = messages("inverse-region-lost");
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0].reason, "lost");
}

}  // namespace
}  // namespace inverse::testing
