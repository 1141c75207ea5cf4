// SPDX-License-Identifier: LGPL-2.1-or-later
// When the color of light is measured, without a device.
#include "kernels/reuse/light_planner.hpp"

#include <gtest/gtest.h>

namespace inverse::testing {
namespace {

using Light = LightPlanner::Light;

struct Video {
  LightPlanner planner;
  LightPlanner::Frame frame{.same_params = true, .had_color = true, .repeated = true};

  LightPlanner::Plan next() { return planner.next(frame); }
  Light after(uint32_t frames) {
    for (uint32_t k = 1; k < frames; ++k) next();
    return next().light;
  }
};

}  // namespace

TEST(LightPlanner, ARepeatedPictureReusesItsLight) {
  Video video;
  for (uint32_t k = 1; k < LightPlanner::kRepeats; ++k)
    EXPECT_EQ(video.next().light, Light::measure) << k;
  EXPECT_EQ(video.next().light, Light::measure_keep);
  for (uint32_t k = 0; k < 100; ++k) {
    const auto plan = video.next();
    ASSERT_TRUE(plan.reused()) << k;
    EXPECT_EQ(plan.skipped.size(), 1U);
  }
}

TEST(LightPlanner, ChangesEndTheReuse) {
  const auto light = [](const auto& change) {
    Video video;
    EXPECT_EQ(video.after(LightPlanner::kRepeats + 2), Light::reuse);
    change(video);
    return video.next().light;
  };
  EXPECT_EQ(light([](Video&) {}), Light::reuse);
  EXPECT_EQ(light([](Video& v) { v.frame.adaptive = false; }), Light::measure);
  EXPECT_EQ(light([](Video& v) { v.frame.same_params = false; }), Light::measure);
  EXPECT_EQ(light([](Video& v) { v.frame.first = true; }), Light::measure);
  EXPECT_EQ(light([](Video& v) { v.frame.repeated = false; }), Light::measure);
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
