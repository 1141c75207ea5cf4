// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsictone: what it changes, what it leaves, which curves it refuses.
#include <cmath>

#include "tests/elements/edit/edit_fixture.hpp"
#include "tests/elements/layer_of.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kTwiceAsBright = "curve=\"-4,-3 4,5\"";
constexpr const char* kLooks[] = {"velvet", "shiny", "metal", "matte"};

class ToneElement : public EditorElement {
 protected:
  std::vector<uint8_t> through(const std::string& tone, int times = 1) const {
    VideoHarness harness("intrinsicdecomp light-color-slope=0 ! " + tone + " ! intrinsiccompose",
                         rgba(), rgba());
    return harness.process(frame, times);
  }
};

}  // namespace

TEST_F(ToneElement, ChangesShadingAndKeepsReflectance) {
  VideoHarness plain("intrinsicdecomp", rgba(), kLayers);
  VideoHarness tone(std::string("intrinsicdecomp ! intrinsictone ") + kTwiceAsBright, rgba(),
                    kLayers);
  const Buffer a = plain.process_buffer(frame), b = tone.process_buffer(frame);
  const auto before = layer_of(a.get(), GST_INVERSE_ROLE_INTRINSIC);
  const auto after = layer_of(b.get(), GST_INVERSE_ROLE_INTRINSIC);
  EXPECT_EQ(layer_of(b.get(), GST_INVERSE_ROLE_MODEL), before);
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i < after.size(); ++i)
    ASSERT_NEAR(after[i], i % 4 == 3 ? 2 * before[i] : before[i], i % 4 == 3 ? 1e-3 * after[i] : 0);
}

TEST_F(ToneElement, EveryLookIsAnotherPicture) {
  std::vector<std::vector<uint8_t>> pictures{frame};
  for (const char* look : kLooks)
    pictures.push_back(through(std::string("intrinsictone look=") + look));
  for (size_t i = 0; i < pictures.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      EXPECT_GT(largest_difference(pictures[i], pictures[k]), 15) << i << " and " << k;
}

TEST_F(ToneElement, NeutralSettingsReturnTheFrameAndDispatchNothing) {
  expect_neutral("intrinsictone", {"", "curve=\"-2,-2 3,3\"", "look=metal strength=0",
                                   "strength=0 curve=\"0,1 1,5\""});
}

TEST_F(ToneElement, FollowsItsPropertiesWhilePlaying) {
  VideoHarness harness("intrinsicdecomp light-color-slope=0 ! intrinsictone ! intrinsiccompose",
                       rgba(), rgba());
  GstElement* tone = harness.find("intrinsictone");
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
  g_object_set(tone, "curve", "-4,-5 4,3", nullptr);  // half as bright
  const auto half = harness.process(frame);
  EXPECT_GT(largest_difference(half, frame), 40);
  g_object_set(tone, "strength", 0.5F, nullptr);
  const auto less = harness.process(frame);
  EXPECT_GT(largest_difference(less, half), 15);
  EXPECT_GT(largest_difference(less, frame), 15);
  g_object_set(tone, "strength", 1.0F, "look", 3 /* metal */, nullptr);
  const auto metal = harness.process(frame);
  EXPECT_GT(largest_difference(metal, half), 30);
  g_object_set(tone, "middle", 4.0F, nullptr);
  EXPECT_GT(largest_difference(harness.process(frame), metal), 20);
  g_object_set(tone, "strength", 0.0F, nullptr);
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_F(ToneElement, StrengthFollowsAController) {
  VideoHarness harness(line("intrinsictone curve=\"-4,-6 4,2\""), rgba(), rgba());
  expect_strength_follows_a_controller(harness, harness.find("intrinsictone"), 6);
}

TEST_F(ToneElement, AMaskConfinesIt) {
  expect_confined_by_a_mask(std::string("intrinsictone ") + kTwiceAsBright);
}

TEST_F(ToneElement, TheColorOfLightFollowsShading) {
  // With a slope, brighter light is redder: pixels of gray paint turn red.
  const auto gray = draw(kWidth, kHeight, [](int x, int, int) { return 60 + x / 2; });
  const auto redness = [&](const char* slope) {
    VideoHarness harness(std::string("intrinsicdecomp light-color-slope=") + slope +
                             " ! intrinsictone curve=\"-4,-2 4,6\" ! intrinsiccompose",
                         rgba(), rgba());
    const auto shown = harness.process(gray);
    const uint8_t* pixel = pixel_at(shown, 20, kHeight / 2, kWidth);
    return pixel[0] - pixel[2];
  };
  EXPECT_GT(redness("0.3"), 20);
  EXPECT_LE(std::abs(redness("0")), 2);
}

TEST_F(ToneElement, LightWithLayersKeepsItsShares) {
  VideoHarness plain("globalintrinsic", rgba(), kGlobal);
  VideoHarness tone(std::string("globalintrinsic ! intrinsictone ") + kTwiceAsBright, rgba(),
                    kGlobal);
  const Buffer a = plain.process_buffer(frame), b = tone.process_buffer(frame);
  EXPECT_EQ(layer_of(a.get(), GST_INVERSE_ROLE_LIGHT), layer_of(b.get(), GST_INVERSE_ROLE_LIGHT));
  const auto before = layer_of(a.get(), GST_INVERSE_ROLE_INTRINSIC);
  const auto after = layer_of(b.get(), GST_INVERSE_ROLE_INTRINSIC);
  ASSERT_FALSE(after.empty());
  for (size_t i = 3; i < after.size(); i += 4)
    ASSERT_NEAR(after[i], 2 * before[i], 1e-3 * after[i]);
}

TEST_F(ToneElement, AWrongCurveIsOneWarningAndTheOneBeforeStays) {
  VideoHarness harness("intrinsicdecomp ! intrinsictone ! intrinsiccompose", rgba(), rgba());
  GstElement* tone = harness.find("intrinsictone");
  g_object_set(tone, "curve", "-4,-5 4,3", nullptr);
  const auto half = harness.process(frame);
  for (const auto& [curve, part] : std::vector<std::pair<const char*, const char*>>{
           {"0,0", "one point"},
           {"0,0 1,1 0,2", "two points at x=0;"},
           {"1,2,3", "put a space"},
           {"nan,0 1,1", "no number"},
           {"0,0 1,1 2,2 3,3 4,4 5,5 6,6 7,7 8,8 9,9 10,10 11,11 12,12 13,13 14,14 15,15 16,16",
            "more than 16 points"}}) {
    g_object_set(tone, "curve", curve, nullptr);
    expect_one(harness.warnings(), part);
    EXPECT_EQ(property<std::string>(tone, "curve"), "-4,-5 4,3");
  }
  EXPECT_LE(largest_difference(harness.process(frame), half), 1);
  g_object_set(tone, "curve", nullptr, nullptr);
  EXPECT_TRUE(harness.warnings().empty());
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
}

TEST_F(ToneElement, AWrongCurveOfALineIsAnErrorThatSaysWhatToWrite) {
  const auto result = run_line(
      "videotestsrc num-buffers=2 ! video/x-raw,width=32,height=24 ! intrinsicdecomp ! "
      "intrinsictone curve=\"0;1\" ! intrinsiccompose ! fakesink");
  EXPECT_FALSE(result.eos);
  expect_contains(result.first_error(), "write points as x,y in stops");
}

TEST_F(ToneElement, AnyFormatAndSizeWorks) {
  expect_any_format_and_size(line("intrinsictone look=metal"));
}

TEST_F(ToneElement, BlackStaysBlackAndWhiteIsNoError) {
  const std::string caps = VideoHarness::caps("RGB", kWidth, kHeight);
  for (const char* look : kLooks)
    for (const int value : {0, 255}) {
      VideoHarness harness(
          std::string("intrinsicdecomp ! intrinsictone look=") + look + " ! intrinsiccompose", caps,
          caps);
      const auto input = flat_frame(caps, static_cast<uint8_t>(value));
      const auto shown = harness.process(input, 2);
      ASSERT_EQ(shown.size(), input.size()) << look;
      if (value == 0) {
        EXPECT_LE(largest_difference(shown, input), 1) << look;
      }
    }
}

}  // namespace inverse::testing
