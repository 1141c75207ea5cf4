// SPDX-License-Identifier: LGPL-2.1-or-later
// Labels of streams that begin, break off and continue: the start of the count, and that each frame
// is reported once.
#include <array>
#include <map>

#include "labeling_by_hand.hpp"

namespace inverse::testing {
namespace {

class MarkerInEveryPass : public ByHand {
 protected:
  static LightProgram program() {
    LightProgram program = performance(some_lights());
    while (program.steps.size() < 40)
      program.steps.push_back(program.steps[program.steps.size() % 2]);
    program.marker = LightProgram::Marker::pass;
    return program;
  }
  MarkerInEveryPass() : ByHand(program()) {}
};

TEST_F(MarkerInEveryPass, AfterDarknessTheCountGoesOn) {
  play(-20, 220);
  play_dark(220, 230);
  ASSERT_FALSE(labeler_.anchored());
  play(230, 400);
  for (uint64_t token = 20; token < tokens_; ++token)
    if (fate(token) == Fate::labeled) {
      EXPECT_EQ(labels_[token].trigger, token - 20);
    }
  EXPECT_EQ(fate(20 + 257), Fate::before_marker);
  for (uint64_t n = 258; n < 400; ++n) EXPECT_EQ(fate(20 + n), Fate::labeled) << n;
  EXPECT_EQ(labeler_.counts().markers, 10U);  // one for each pass of 43
  EXPECT_EQ(labeler_.counts().late, 0U);
}

TEST_F(MarkerInEveryPass, AProgramThatIsStartedAgainElsewhereCountsFromItsStart) {
  play(-20, 120);
  play_at(140, -20, 60);
  expect_last(59U);
}

TEST_F(MarkerInEveryPass, ACameraThatComesLateCountsAsOthersDo) {
  // Another camera's frames are stamped a quarter of a pass earlier.
  running_ = FrameLabeler::Running{at(500 - 10.7), 500, 7, false};
  play(500, 640);
  expect_last(639U);
  EXPECT_EQ(labels_.back().position.pass, 14U);
  EXPECT_EQ(labels_.back().start.run, 7U);
  EXPECT_FALSE(labels_.back().start.apart);
}

TEST_F(MarkerInEveryPass, ACameraThatComesLateAndHasOtherTimesCountsAlone) {
  running_ = FrameLabeler::Running{at(500 - 21), 500, 7, false};
  play(500, 640);
  expect_last(639U - 43 * 12);
  EXPECT_FALSE(labels_.back().start.run);
  EXPECT_TRUE(labels_.back().start.apart);
}

TEST_F(MarkerInEveryPass, ACameraThatSeesANewStartFirstDropsTheOldOne) {
  play(-20, 120);
  EXPECT_EQ(labels_[tokens_ - 1].start.number, 1U);
  running_ = FrameLabeler::Running{at(120), 120, 7, true};
  // Near to where a pass would have begun.
  play_at(132, -9, 60);
  expect_last(59U);
  EXPECT_EQ(labels_.back().start.number, 2U);
  EXPECT_FALSE(labels_.back().start.run);
}

TEST_F(MarkerInEveryPass, ACameraThatSeesANewStartLateCountsAsOthersDo) {
  play(-20, 120);
  running_ = FrameLabeler::Running{at(160), 20, 8, false};
  play_at(140, -20, 60);
  EXPECT_EQ(labels_.back().trigger, 59U);
  EXPECT_EQ(labels_.back().start.run, 8U);
}

class Unmarked : public ByHand {
 protected:
  static LightProgram program() {
    LightProgram program = static_capture(some_lights(40));
    program.marker = LightProgram::Marker::none;
    program.repeat = 2;
    return program;
  }
  Unmarked() : ByHand(program()) {}
};

TEST_F(Unmarked, AClockThatJumpsEndsTheLabels) {
  play(0, 30);
  const uint64_t first = tokens_;
  play_at(500.5, 30, 80);
  for (uint64_t token = first; token < tokens_; ++token)
    if (fate(token) == Fate::labeled) {
      EXPECT_EQ(labels_[token].trigger, 530 + token - first);
    }
  play_at(-2000.5, 80, 160);
  EXPECT_FALSE(labeler_.anchored());
  EXPECT_EQ(labels_.back().fate, Fate::before_marker);
  EXPECT_EQ(labeler_.counts().resynchronizations, 1U);
  EXPECT_FALSE(labeler_.take_overdue());
  // Another stream starts with the first frame again.
  collect(labeler_.drain());
  labeler_.reset();
  const uint64_t anew = tokens_;
  play(0, 30);
  EXPECT_EQ(labels_[anew + 5].fate, Fate::labeled);
  EXPECT_EQ(labels_[anew + 5].trigger, 5U);
}

TEST_F(Unmarked, WhatComesAfterTheEndIsNotTheStart) {
  const auto triggers = static_cast<int64_t>(*program_.triggers());
  play(0, triggers + 40);
  EXPECT_EQ(labeler_.counts().labeled, static_cast<uint64_t>(triggers));
  EXPECT_EQ(labeler_.counts().ended, 40U);
}

/// For any input, each pushed frame is reported once: elements rely on that.
TEST(Labeling, EveryFrameIsReportedExactlyOnce) {
  using Marker = LightProgram::Marker;
  std::vector<LightProgram> programs{performance(some_lights()), static_capture(some_lights(40)),
                                     featureless()};
  programs[1].repeat = 2;
  std::map<Fate, uint64_t> fates;
  for (uint64_t seed = 0; seed < 240; ++seed) {
    std::mt19937_64 random(seed);
    const auto chance = [&](double share) {
      return std::uniform_real_distribution<double>(0, 1)(random) < share;
    };
    LightProgram program = programs[seed % 3];
    program.marker = std::array{Marker::start, Marker::pass, Marker::none}[seed / 3 % 3];
    const uint32_t bits = std::array{0U, 0U, 16U, 64U}[seed / 9 % 4];
    HandCamera camera(program, bits);
    std::vector<int> reports;
    const auto collect = [&](const HandCamera::Labels& labels) {
      for (const auto& one : labels) {
        ASSERT_LT(one.token, reports.size());
        ++reports[one.token];
        ++fates[one.fate];
      }
    };
    int64_t lit = -20, time = 0;  // where the lights are, and the clock
    uint64_t dark = 0;
    for (int i = 0; i < 1500; ++i, ++lit, ++time) {
      if (chance(0.004)) lit = -5;                  // started again
      if (chance(0.004)) dark = 1 + random() % 60;  // covered
      if (chance(0.003)) time += static_cast<int64_t>(random() % 2000) - 1000;
      if (chance(0.02)) continue;
      const ImageEvidence image = camera.picture(dark ? -1 : lit);
      dark -= dark ? 1 : 0;
      const double off = chance(0.02) ? 0.7 : std::uniform_real_distribution(-0.3, 0.3)(random);
      for (int copies = chance(0.02) ? 3 : 1; copies; --copies) {
        FrameLabeler::Frame frame{reports.size(), std::nullopt, std::nullopt, image};
        if (!chance(0.005))
          frame.time = static_cast<int64_t>((static_cast<double>(time) + off + 5000) * 1e9 / 60);
        if (bits) frame.id = static_cast<uint64_t>(time + 60000) & (bits == 16 ? 0xffff : ~0ULL);
        reports.push_back(0);
        collect(camera.labeler_.push(frame));
      }
      if (!chance(0.004)) continue;
      collect(camera.labeler_.drain());          // the stream ends here
      if (chance(0.7)) camera.labeler_.reset();  // and another one begins
      for (size_t token = 0; token < reports.size(); ++token)
        ASSERT_EQ(reports[token], 1) << "seed " << seed << " frame " << token;
    }
    collect(camera.labeler_.drain());
    uint64_t sum = 0;
    const auto& c = camera.labeler_.counts();
    for (const uint64_t count : {c.labeled, c.duplicates, c.late, c.ambiguous, c.contradicted,
                                 c.before_marker, c.ended, c.untimed})
      sum += count;
    EXPECT_EQ(sum, reports.size()) << seed;
    EXPECT_EQ(c.frames, reports.size()) << seed;
    for (size_t token = 0; token < reports.size(); ++token)
      ASSERT_EQ(reports[token], 1) << "seed " << seed << " frame " << token;
  }
  EXPECT_EQ(fates.size(), 8U);  // all of them happen
}

}  // namespace
}  // namespace inverse::testing
