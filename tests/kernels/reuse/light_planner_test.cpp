// SPDX-License-Identifier: LGPL-2.1-or-later
// When the color of light is measured, without a device.
#include "kernels/reuse/light_planner.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace inverse::testing {
namespace {

using Light = LightPlanner::Light;

/// 10 x 10 tiles, of which some change with every frame.
struct Video {
  LightPlanner planner;
  LightPlanner::Frame frame{.same_params = true, .had_color = true, .columns = 10};
  std::vector<uint8_t> changed = std::vector<uint8_t>(100);

  LightPlanner::Plan next() {
    frame.changed = changed;
    return planner.next(frame);
  }
  Light after(uint32_t frames) {
    for (uint32_t k = 1; k < frames; ++k) next();
    return next().light;
  }
};

}  // namespace

TEST(LightPlanner, AStaticVideoReusesItsLightAndMeasuresItAtTimes) {
  Video video;
  for (uint32_t k = 1; k < LightPlanner::kStaticFrames; ++k)
    EXPECT_EQ(video.next().light, Light::measure) << k;
  EXPECT_EQ(video.next().light, Light::measure_keep);
  for (int round = 0; round < 3; ++round) {
    for (uint32_t k = 0; k < LightPlanner::kReuseFrames; ++k) {
      const auto plan = video.next();
      ASSERT_TRUE(plan.reused()) << k;
      EXPECT_EQ(plan.skipped.size(), 1U);
    }
    for (uint32_t k = 0; k < LightPlanner::kMeasureFrames; ++k)
      ASSERT_EQ(video.next().light, Light::measure) << k;
    ASSERT_EQ(video.next().light, Light::measure_keep);
  }
}

TEST(LightPlanner, ChangesEndTheReuse) {
  const auto light = [](const auto& change) {
    Video video;
    EXPECT_EQ(video.after(LightPlanner::kStaticFrames + 2), Light::reuse);
    change(video);
    return video.next().light;
  };
  EXPECT_EQ(light([](Video&) {}), Light::reuse);
  EXPECT_EQ(light([](Video& v) { v.frame.adaptive = false; }), Light::measure);
  EXPECT_EQ(light([](Video& v) { v.frame.same_params = false; }), Light::measure);
  EXPECT_EQ(light([](Video& v) { v.frame.first = true; }), Light::measure);
  EXPECT_EQ(light([](Video& v) { v.changed.clear(); }), Light::measure);
  // A changed tile and its neighbors: 9 of 100; three rows and a fourth beside them: 40.
  EXPECT_EQ(light([](Video& v) { v.changed[44] = 1; }), Light::reuse);
  EXPECT_EQ(light([](Video& v) {
              for (size_t i = 40; i < 60; ++i) v.changed[i] = 1;
            }),
            Light::measure);
}

TEST(LightPlanner, AChangeThatMovesEndsTheReuseWhenItHasPassedTooManyTiles) {
  Video video;
  video.after(LightPlanner::kStaticFrames);
  size_t frames = 0;
  for (size_t tile = 0; tile < 100; tile += 3, ++frames) {
    video.changed.assign(100, 0);
    video.changed[tile] = 1;
    if (!video.next().reused()) break;
  }
  // Three columns a step in two to three rows: 40 tiles are passed after some eight steps.
  EXPECT_GT(frames, 4U);
  EXPECT_LT(frames, 12U);
  EXPECT_EQ(video.planner.tiles().size(), 100U);
}

TEST(LightPlanner, AGraySceneIsSeenAfterSomeFramesAndColorAtOnce) {
  Video video;
  video.frame.had_color = false;
  for (uint32_t k = 1; k < LightPlanner::kGrayFrames; ++k) EXPECT_FALSE(video.next().gray) << k;
  const auto plan = video.next();
  EXPECT_TRUE(plan.gray);
  EXPECT_EQ(plan.light, Light::measure);
  EXPECT_EQ(plan.skipped.size(), 1U);
  video.frame.had_color = true;
  EXPECT_FALSE(video.next().gray);
  video.frame.had_color = false;
  for (uint32_t k = 0; k < 20; ++k) video.next();
  EXPECT_TRUE(video.next().gray);
  video.frame.light_asked = true;
  EXPECT_FALSE(video.next().gray) << "an amount set by hand needs no color";
  video.frame.light_asked = false;
  video.frame.had_color.reset();
  EXPECT_FALSE(video.next().gray) << "nothing is known yet";
}

}  // namespace inverse::testing
