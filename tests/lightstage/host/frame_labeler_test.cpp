// SPDX-License-Identifier: LGPL-2.1-or-later
// Labels of a light stage's frames: none is wrong, and every loss is counted.
#include "kernels/lightstage/labels/frame_labeler.hpp"

#include <gtest/gtest.h>

#include "labeling_by_hand.hpp"

namespace inverse::testing {
namespace {

LightProgram endless_static() {
  LightProgram program = static_capture(some_lights(331));
  program.repeat = 0;
  return program;
}

void expect_all_right(const SimulationResult& result, const std::string& what) {
  EXPECT_EQ(result.mislabeled, 0U) << what;
  EXPECT_LE(static_cast<double>(result.ambiguous), 0.01 * static_cast<double>(result.sent)) << what;
  EXPECT_EQ(result.counts.missing, result.lost) << what;
  EXPECT_EQ(result.counts.resynchronizations, 0U) << what;
  EXPECT_EQ(result.counts.markers, 1U) << what;
}

class Programs : public ::testing::TestWithParam<int> {
 protected:
  LightProgram program() const {
    return GetParam() == 0   ? performance(some_lights())
           : GetParam() == 1 ? endless_static()
                             : featureless();
  }
};
INSTANTIATE_TEST_SUITE_P(Labeling, Programs, ::testing::Values(0, 1, 2));

TEST_P(Programs, TenThousandFramesByTimesAlone) {
  const LightProgram lights = program();
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    CameraSimulation camera;
    camera.seed = seed;
    camera.idle = seed % 3 == 0 ? 0 : 50;
    camera.drift = seed % 2 ? 120 : -120;
    camera.distribution =
        seed % 4 < 2 ? CameraSimulation::Jitter::uniform : CameraSimulation::Jitter::normal;
    expect_all_right(simulate(lights, camera, {}), "seed " + std::to_string(seed));
  }
}

TEST_P(Programs, TenThousandFramesByIds) {
  const LightProgram lights = program();
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    CameraSimulation camera;
    camera.seed = seed;
    camera.idle = seed % 3 == 0 ? 0 : 50;
    camera.id_bits = seed % 3 == 0 ? 16 : seed % 3 == 1 ? 64 : 32;
    camera.first_id = camera.id_bits == 16 ? 65400 : ~uint64_t{0} - 3000;
    camera.ids_skip_zero = seed % 2;
    const auto result = simulate(lights, camera, {.id_bits = camera.id_bits});
    expect_all_right(result, "seed " + std::to_string(seed));
    // Single lights behind the last tracking frame are not confirmed.
    const uint64_t open = GetParam() == 1 ? 12 : 0;
    EXPECT_GE(result.labeled + open, result.sent) << seed;
  }
}

TEST(Labeling, OneProgramWhoseFullFrameIsLost) {
  const LightProgram lights = performance(some_lights());
  uint64_t found = 0;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const auto result =
        simulate(lights, {.frames = 500, .full_frame_lost = true, .seed = seed}, {});
    EXPECT_EQ(result.mislabeled, 0U) << seed;
    EXPECT_LE(result.ambiguous, result.counts.markers ? 12U : 500U) << seed;
    found += result.counts.markers;
  }
  EXPECT_GE(found, 18U);  // the blacks beside it may be lost, too
}

TEST(Labeling, SingleLightsWhoseFullFrameIsLost) {
  const LightProgram lights = static_capture(some_lights(331));
  uint64_t found = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    const auto result =
        simulate(lights, {.frames = *lights.triggers(), .full_frame_lost = true, .seed = seed}, {});
    EXPECT_EQ(result.mislabeled, 0U) << seed;
    EXPECT_LE(result.ambiguous, result.counts.markers ? 3U : *lights.triggers()) << seed;
    found += result.counts.markers;
  }
  EXPECT_GE(found, 34U);  // one of the deciding frames may be lost, too
}

TEST_F(ByHand, TheMarkerItselfIsLabeledAndWhatWasBeforeIsNot) {
  play(-20, 10);
  ASSERT_TRUE(labeler_.anchored());
  for (uint64_t token = 0; token < 20; ++token) EXPECT_EQ(fate(token), Fate::before_marker);
  for (uint64_t n = 0; n < 10; ++n) {
    EXPECT_EQ(fate(20 + n), Fate::labeled) << n;
    EXPECT_EQ(labels_[20 + n].trigger, n);
  }
}

TEST_F(ByHand, AMissingMarkerIsReportedOnce) {
  play(-400, -105);
  EXPECT_FALSE(labeler_.take_overdue());
  play(-105, 0);
  EXPECT_TRUE(labeler_.take_overdue());
  EXPECT_FALSE(labeler_.take_overdue());
  EXPECT_EQ(labeler_.counts().labeled, 0U);
}

TEST_F(ByHand, AFrameThatIsStampedAPeriodLateIsNotTakenForTheNext) {
  play(-20, 100);
  // The picture of trigger 100 with the time of 101; 101 itself is lost.
  const uint64_t late = push(101, picture(100));
  play(102, 120);
  EXPECT_NE(fate(late), Fate::labeled);
  EXPECT_EQ(labeler_.counts().missing, 1U);
  EXPECT_EQ(labels_[late + 18].trigger, 119U);
}

TEST_F(ByHand, ADoubleThatIsStampedAPeriodLateIsADouble) {
  play(-20, 100);
  ImageEvidence image = picture(100);
  push(100, image);
  const uint64_t again = push(101, image);
  play(102, 120);
  EXPECT_EQ(fate(again), Fate::duplicate);
  EXPECT_EQ(labeler_.counts().duplicates, 1U);
  EXPECT_EQ(labeler_.counts().missing, 1U);
}

TEST_F(ByHand, OffBeatAndOutOfOrderFramesAreDroppedAndCounted) {
  play(-20, 100);
  const uint64_t between = push(100.5, picture(100));
  push(102, picture(102));
  const uint64_t old = push(101, picture(101));
  play(103, 110);
  // Half a period off: only the image shows it.
  EXPECT_TRUE(fate(between) != Fate::labeled || labels_[between].trigger == 100);
  EXPECT_EQ(fate(old), Fate::late);
  EXPECT_EQ(labeler_.counts().late, 1U);
  EXPECT_EQ(labeler_.counts().missing, 0U);
}

TEST_F(ByHand, AGapIsCountedAndBridged) {
  play(-20, 100);
  play(700, 720);
  EXPECT_EQ(labeler_.counts().missing, 600U);
  EXPECT_EQ(labels_.back().trigger, 719U);
}

TEST_F(ByHand, AProgramThatIsStartedAgainIsFollowed) {
  play(-20, 101);
  play_at(130, -20, 40);
  EXPECT_TRUE(labeler_.anchored());
  expect_last(39U);
  EXPECT_EQ(labeler_.counts().markers, 2U);
  EXPECT_EQ(labeler_.counts().resynchronizations, 1U);
}

TEST_F(ByHand, LightsThatSlipByAStepAreNotFollowedBlindly) {
  play(-20, 100);
  const uint64_t first = tokens_;
  for (int64_t n = 100; n < 160; ++n) push(static_cast<double>(n), picture(n + 1));
  expect_none_labeled(first);
  EXPECT_FALSE(labeler_.anchored());
}

TEST_F(ByHand, ExposureThatChangesSlowlyAndAmbientLightAreFollowed) {
  for (int64_t n = -20; n < 2000; ++n) {
    ImageEvidence image = picture(n);
    for (double& level : image.level)
      level = level * (1 + 0.7 * std::sin(static_cast<double>(n) / 200)) + 0.05;
    push(static_cast<double>(n), image);
  }
  EXPECT_EQ(labeler_.counts().labeled, 2000U);
}

TEST_F(ByHand, PicturesInAnotherFrameGoOnWithTheCount) {
  play(-20, 100);
  for (const double scale : {0.3, 4.0, 1.0}) {
    const uint64_t first = tokens_;
    const auto from = static_cast<int64_t>(labels_.back().trigger) + 1;
    collect(labeler_.new_framing());
    play_scaled(from, from + 50, scale);
    for (uint64_t token = first; token < tokens_; ++token)
      EXPECT_EQ(fate(token), Fate::labeled) << scale << ": " << token - first;
  }
  EXPECT_EQ(labeler_.counts().resynchronizations, 0U);
}

TEST_F(ByHand, LightsThatSlipWhileTheFrameChangesAreNotFollowed) {
  play(-20, 100);
  collect(labeler_.new_framing());
  const uint64_t first = tokens_;
  play_scaled(100, 160, 3, 1);
  expect_none_labeled(first + 2);
  EXPECT_FALSE(labeler_.anchored());
}

TEST_F(ByHand, LightsThatStopWhileTheFrameChangesAreNotFollowed) {
  play(-20, 100);
  collect(labeler_.new_framing());
  play_scaled(100, 160, 0.02);
  EXPECT_FALSE(labeler_.anchored());
}

TEST_F(ByHand, AMarkerIsFoundAfterFramesOfAnotherSize) {
  play_scaled(-20, 2, 0.1);
  collect(labeler_.new_framing());
  for (int64_t n = -18; n < 40; ++n) push(static_cast<double>(n + 20), scaled(n, 1));
  EXPECT_TRUE(labeler_.anchored());
  EXPECT_EQ(labels_.back().trigger, 39U);
  EXPECT_EQ(labeler_.counts().labeled, 40U);
}

TEST_F(ByHand, FlushKeepsTheStartOfTheProgram) {
  play(-20, 100);
  labeler_.flush();
  play(1000, 1010);
  EXPECT_EQ(labels_.back().trigger, 1009U);
  labeler_.flush();
  play(50, 60);  // back
  EXPECT_EQ(labels_.back().trigger, 59U);
  EXPECT_EQ(labeler_.counts().late, 0U);
}

TEST_F(ByHand, MissingAndInvalidTimestamps) {
  play(-20, 100);
  collect(labeler_.push({tokens_++, std::nullopt, std::nullopt, picture(100)}));
  EXPECT_EQ(labels_.back().fate, Fate::untimed);
  push(-1e9, picture(100));
  push(1e9, picture(100));
  ImageEvidence broken = picture(101);
  broken.level.fill(std::nan(""));
  push(101, broken);
  play(102, 110);
  EXPECT_EQ(labels_.back().trigger, 109U);
}

class SingleLights : public ByHand {
 protected:
  SingleLights() : ByHand(static_capture(some_lights(331))) {}
};

TEST_F(SingleLights, TwoFramesThatClaimOneTriggerAreBothDropped) {
  play(-20, 60);
  // The picture of light 60 − 3 − …, a period late, and the one whose time that is.
  const uint64_t late = push(60.9, picture(60));
  const uint64_t rightful = push(61, picture(61));
  play(62, 100);
  EXPECT_EQ(fate(late), Fate::ambiguous);
  EXPECT_EQ(fate(rightful), Fate::ambiguous);
  for (uint64_t token = 20; token + 1 < labels_.size(); ++token)
    if (fate(token) == Fate::labeled) {
      EXPECT_EQ(labels_[token].trigger, token - 20) << token;
    }
  EXPECT_EQ(labeler_.counts().missing, 0U);
  EXPECT_EQ(labeler_.counts().labeled, 98U);
}

TEST_F(SingleLights, InAnotherFrameAreConfirmedByTheNextTrackingFrame) {
  play(-20, 30);
  collect(labeler_.new_framing());
  EXPECT_EQ(labels_.size(), 20U + 30) << "what waited is reported";
  play_scaled(30, 100, 0.4);
  for (uint64_t token = 50; token < labels_.size(); ++token) {
    EXPECT_EQ(fate(token), Fate::labeled) << token;
    EXPECT_EQ(labels_[token].trigger, token - 20);
  }
  EXPECT_EQ(labeler_.counts().contradicted, 0U);
}

TEST_F(SingleLights, ThatSlipWhileTheFrameChangesAreNotFollowed) {
  play(-20, 30);
  collect(labeler_.new_framing());
  const uint64_t first = tokens_;
  play_scaled(30, 120, 0.4, 1);
  for (uint64_t token = first; token < labels_.size(); ++token)
    EXPECT_NE(fate(token), Fate::labeled) << token - first;
  EXPECT_FALSE(labeler_.anchored());
}

TEST_F(SingleLights, LeaveWithTheTrackingFrameThatConfirmsThem) {
  play(-20, 36);
  EXPECT_EQ(labels_.size(), 20U + 27);  // 26 is the second tracking frame
  play(36, 39);
  EXPECT_EQ(labels_.size(), 20U + 39);
  EXPECT_EQ(FrameLabeler::longest_wait(program_, params(0)), 23U);
  EXPECT_EQ(FrameLabeler::longest_wait(performance(some_lights()), params(0)), 0U);
}

TEST_F(SingleLights, AProgramThatIsStartedAgainAnywhereHasNoWrongLabel) {
  for (int64_t stop = 60; stop < 100; ++stop)
    for (const int64_t pause : {0, 1, 5, 40}) {
      HandCamera again(program_);
      again.play(-20, stop);
      // The lights are stopped, and start with the marker after a pause.
      again.play_dark(stop, stop + pause);
      again.play_at(static_cast<double>(stop + pause), 0, 60);
      again.collect(again.labeler_.drain());
      const auto first = static_cast<uint64_t>(20 + stop);
      const auto marker = first + static_cast<uint64_t>(pause);
      // If the marker's full frame coincides with the next tracking frame, nothing distinguishes
      // them.
      const bool unlucky =
          pause < 12 && program_.kind(program_.at(marker - 20 + 1)) == StepKind::tracking;
      for (uint64_t token = 20; token < again.tokens_; ++token) {
        if (again.fate(token) != Fate::labeled) continue;
        if (unlucky && token >= first && token < marker + 2) continue;
        ASSERT_TRUE(token < first || token >= marker)
            << stop << " " << pause << " " << token - first;
        ASSERT_EQ(again.labels_[token].trigger, token < first ? token - 20 : token - marker)
            << stop << " " << pause << " " << token;
      }
      EXPECT_TRUE(again.labeler_.anchored()) << stop << " " << pause;
      EXPECT_EQ(again.fate(marker + 50), Fate::labeled) << stop << " " << pause;
    }
}

TEST_F(SingleLights, LightsThatStopAreNoSingleLights) {
  play(-20, 100);
  const uint64_t first = tokens_;
  play_dark(100, 200);
  collect(labeler_.drain());
  expect_none_labeled(first);
  EXPECT_FALSE(labeler_.anchored());
}

TEST_F(SingleLights, UnconfirmedFramesAreNotLabeledAtTheEnd) {
  play(-20, 60);
  play_dark(60, 68);
  collect(labeler_.drain());
  EXPECT_EQ(fate(20 + 50), Fate::labeled);  // a tracking frame
  for (uint64_t token = 20 + 51; token < tokens_; ++token)
    EXPECT_EQ(fate(token), token == 20 + 62 ? Fate::contradicted : Fate::ambiguous) << token;
  EXPECT_EQ(labeler_.counts().labeled, 51U);
  EXPECT_EQ(labeler_.counts().ambiguous, 16U);
  // Nothing is left of it that the next stream could stumble over.
  const uint64_t next = push(67, picture(70));
  collect(labeler_.drain());
  EXPECT_NE(fate(next), Fate::labeled);
}

TEST_F(SingleLights, RareFlashesAreIgnored) {
  const auto triggers = static_cast<int64_t>(*program_.triggers());
  for (int64_t n = -20; n < triggers; ++n)
    push(static_cast<double>(n), picture(n > 20 && n % 12 == 7 ? 1 : n));
  EXPECT_EQ(labeler_.counts().resynchronizations, 0U);
  EXPECT_GT(labeler_.counts().labeled, static_cast<uint64_t>(triggers) * 9 / 10);
}

TEST_F(SingleLights, EachFrameIsReportedOnceEvenIfSentThrice) {
  std::vector<int> reports;
  const auto count = [&](const Labels& labels) {
    for (const auto& one : labels) {
      if (reports.size() <= one.token) reports.resize(one.token + 1);
      ++reports[one.token];
    }
  };
  for (int64_t n = -20; n < 200; ++n) {
    const ImageEvidence image = picture(n);
    for (int i = 0; i < 3; ++i)
      count(labeler_.push({tokens_++, (n + 100) * 1000000000 / 60, std::nullopt, image}));
  }
  count(labeler_.drain());
  ASSERT_EQ(reports.size(), tokens_);
  for (const int times : reports) EXPECT_EQ(times, 1);
}

TEST_F(SingleLights, FramesThatAreStampedLateDoNotSpoilACapture) {
  const auto triggers = static_cast<int64_t>(*program_.triggers());
  uint64_t wrong = 0, labeled = 0, all = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    HandCamera camera(program_);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<int64_t> truth;
    for (int64_t n = -20; n < triggers; ++n) {
      if (n != 1 && unit(random) < 0.02) continue;
      const bool late = unit(random) < 0.01;
      const double off = late ? 0.5 + 0.25 * unit(random) : 0.2 * unit(random) - 0.1;
      truth.push_back(late ? -1 : n);
      camera.push(static_cast<double>(n) + off, camera.picture(n));
    }
    camera.collect(camera.labeler_.drain());
    for (uint64_t token = 0; token < truth.size(); ++token) {
      if (camera.fate(token) != Fate::labeled || truth[token] < 0) continue;
      ++labeled;
      wrong += camera.labels_[token].trigger != static_cast<uint64_t>(truth[token]) ? 1 : 0;
    }
    all += static_cast<uint64_t>(triggers);
  }
  EXPECT_EQ(wrong, 0U);
  printf("static captures, 1 %% stamped late, 2 %% lost: %.1f %% labeled\n",
         100.0 * static_cast<double>(labeled) / static_cast<double>(all));
  EXPECT_GT(labeled, all * 8 / 10);
}

TEST_F(SingleLights, AFlashIsOneFrame) {
  play(-20, 60);
  ImageEvidence flash = picture(1);
  const uint64_t lit = push(60, flash);
  play(61, 200);
  EXPECT_EQ(fate(lit), Fate::contradicted);
  EXPECT_EQ(labeler_.counts().contradicted, 1U);
  EXPECT_EQ(labeler_.counts().resynchronizations, 0U);
  EXPECT_EQ(labels_.back().fate, Fate::labeled);
  EXPECT_EQ(labeler_.counts().missing, 0U);
}

TEST_F(SingleLights, ATrackingFrameThatIsStampedLateIsOneFrame) {
  play(-20, 62);  // 62 is a tracking frame
  ASSERT_EQ(program_.kind(program_.at(62)), StepKind::tracking);
  const uint64_t late = push(63, picture(62));
  play(64, 200);
  EXPECT_EQ(fate(late), Fate::contradicted);
  EXPECT_EQ(labeler_.counts().resynchronizations, 0U);
  EXPECT_EQ(labeler_.counts().missing, 1U);
  for (uint64_t token = late + 1; token < labels_.size(); ++token)
    EXPECT_EQ(labels_[token].trigger, token - late + 63);
}

class ShortProgram : public ByHand {
 protected:
  static LightProgram program() {
    LightProgram program = performance(some_lights());
    program.repeat = 10;
    return program;
  }
  ShortProgram() : ByHand(program()) {}
};

TEST_F(ShortProgram, EndsAndMayComeAgain) {
  play(-20, 23);
  EXPECT_EQ(labeler_.counts().labeled, 23U);
  const uint64_t after = push(23, picture(-1));
  EXPECT_EQ(fate(after), Fate::ended);
  play_dark(24, 600);
  EXPECT_GT(labeler_.counts().ended, 570U);
  EXPECT_FALSE(labeler_.take_overdue());
  play_at(600, 0, 23);
  EXPECT_EQ(labeler_.counts().labeled, 46U);
  EXPECT_EQ(labels_.back().trigger, 22U);
}

class WithIds : public ByHand {
 protected:
  WithIds() : ByHand(performance(some_lights()), 16) {}
  void play_ids(int64_t from, int64_t to, int64_t first_id) {
    for (int64_t n = from; n < to; ++n)
      push(static_cast<double>(n), picture(n), static_cast<uint64_t>(n - from + first_id));
  }
};

TEST_F(WithIds, ACameraThatIsStartedAgainCountsFromWhereItsTimesAre) {
  play_ids(-20, 100, 500);
  play_ids(200, 240, 1);
  expect_last(239U);
}

TEST_F(WithIds, ACameraThatMissesATriggerWithoutCountingItIsCaught) {
  play_ids(-20, 100, 500);
  play_ids(101, 140, 620);
  for (uint64_t token = 0; token < tokens_; ++token)
    if (fate(token) == Fate::labeled && token >= 120) {
      EXPECT_EQ(labels_[token].trigger, token - 119 + 100);
    }
  EXPECT_EQ(labels_.back().trigger, 139U);
}

}  // namespace
}  // namespace inverse::testing
