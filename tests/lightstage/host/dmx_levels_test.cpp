// SPDX-License-Identifier: LGPL-2.1-or-later
#include "kernels/lightstage/controllers/dmx_levels.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "common/error.hpp"
#include "tests/expect_error.hpp"
#include "two_lights.hpp"

namespace inverse::testing {
namespace {

TEST(DmxLevels, AreLinearAndRounded) {
  const LightProgram program = two_lights();
  const DmxPatch patch(program, 7);
  EXPECT_EQ(patch.universes(), (std::map<uint32_t, uint32_t>{{7, 3}, {8, 3}}));
  const auto levels = patch.levels(std::vector<LightColor>{{1, .5F, 0}, {.001F, .002F, .25F}});
  ASSERT_EQ(levels.size(), 2U);
  DmxUniverse first{}, second{};
  first[0] = 255, first[1] = 128;
  second[1] = 1, second[2] = 64;  // .255 rounds to 0, .51 to 1
  EXPECT_EQ(levels.at(7), first);
  EXPECT_EQ(levels.at(8), second);
}

TEST(DmxLevels, GrayAndWhiteLights) {
  LightProgram program = two_lights();
  program.lights[0].channels = {512};
  program.lights[1].channels = {513};
  const DmxPatch gray(program, 1);
  const auto levels = gray.levels(std::vector<LightColor>{{.2F, .4F, .9F}, {1, 1, 1}});
  EXPECT_EQ(levels.at(1)[511], 128);  // .5
  EXPECT_EQ(levels.at(2)[0], 255);
  EXPECT_EQ(gray.universes(), (std::map<uint32_t, uint32_t>{{1, 512}, {2, 1}}));

  program.lights[0].channels = {1, 2, 3, 4};
  program.lights[1].channels = {5, 6, 7, 8};
  const DmxPatch white(program, 1);
  const auto with = white.levels(std::vector<LightColor>{{.2F, .4F, 1}, {1, 1, 1}}).at(1);
  const std::vector<uint8_t> expected = {0, 51, 204, 51, 0, 0, 0, 255};
  EXPECT_EQ(std::vector(with.begin(), with.begin() + 8), expected);
}

TEST(DmxLevels, LevelsRoundTrip) {
  for (const std::vector<uint32_t>& shape : {std::vector<uint32_t>{1}, {1, 2, 3}, {1, 2, 3, 4}}) {
    LightProgram program = two_lights();
    program.lights[0].channels = program.lights[1].channels = shape;
    for (uint32_t& channel : program.lights[1].channels) channel += 600;
    const DmxPatch patch(program, 1);
    for (int i = 0; i < 256; ++i) {
      const float x = static_cast<float>(i) / 255, y = shape.size() == 1 ? x : 1 - x;
      const auto back = patch.colors(patch.levels(std::vector<LightColor>{{x, y, x}, {y, x, y}}));
      for (size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(back[0][c], c == 1 ? y : x, 1e-6);
        EXPECT_NEAR(back[1][c], c == 1 ? x : y, 1e-6);
      }
    }
  }
  EXPECT_EQ(DmxPatch(two_lights(), 1).colors({}), (std::vector<LightColor>(2)));
}

TEST(DmxLevels, InvalidLightIsBlack) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const DmxPatch patch(two_lights(), 1);
  const auto levels = patch.levels(std::vector<LightColor>{{kNan, -1, kInf}, {-kInf, 2, 0}});
  EXPECT_EQ(levels.at(1)[0], 0);
  EXPECT_EQ(levels.at(1)[1], 0);
  EXPECT_EQ(levels.at(1)[2], 255);
  EXPECT_EQ(levels.at(2)[0], 0);
  EXPECT_EQ(levels.at(2)[1], 255);
}

TEST(DmxLevels, ProgramsWithoutChannelsAreErrors) {
  LightProgram program = two_lights();
  program.lights[1].channels.clear();
  expect_error(ErrorKind::unsupported, "light 1 of \"two lights\" has no channels", [&] {
    DmxPatch{program, 1};
  });
  expect_error(ErrorKind::unsupported, "would be in universe 64000, the last one is 63999",
               [] { DmxPatch(two_lights(), 63999); });
}

}  // namespace
}  // namespace inverse::testing
