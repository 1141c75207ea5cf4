// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicstylize: what it draws, and what it leaves.
#include <cmath>

#include "tests/elements/edit/edit_fixture.hpp"
#include "tests/elements/layer_of.hpp"

namespace inverse::testing {
namespace {

class StylizeElement : public EditorElement {
 protected:
  /// Mean of the green channel of a part of a row.
  static double mean_of_row(const std::vector<uint8_t>& shown, int y, int from, int to) {
    double sum = 0;
    for (int x = from; x < to; ++x) sum += pixel_at(shown, x, y, kWidth)[1];
    return sum / (to - from);
  }
};

}  // namespace

TEST_F(StylizeElement, DrawsALineAtTheEdgeOfAShadowAndNoneBetweenPaints) {
  VideoHarness harness(
      "intrinsicdecomp light-color-slope=0 adaptive=false ! intrinsicstylize scale=1.5 "
      "sensitivity=2.5 sharpness=5 levels=0 flatten=0 ! intrinsiccompose",
      rgba(), rgba());
  const auto shown = harness.process(frame, 3);
  // Of the blue paint.
  const int edge = 2 * kHeight / 3 + 1;
  const double in_shadow = mean_of_row(frame, edge + 12, 60, 90);
  double darkest = 255;
  for (int y = edge - 2; y < edge + 4; ++y)
    darkest = std::min(darkest, mean_of_row(shown, y, 60, 90));
  EXPECT_LT(darkest, 0.5 * in_shadow);
  EXPECT_NEAR(mean_of_row(shown, edge + 12, 60, 90), in_shadow, 3) << "no line in the shadow";
  // Where paints meet in even light, the darker one does not get darker.
  for (int y = 10; y < 30; ++y)
    for (int x = kWidth / 2 - 6; x < kWidth / 2 + 6; ++x)
      ASSERT_GT(pixel_at(shown, x, y, kWidth)[1], pixel_at(frame, x, y, kWidth)[1] - 25)
          << x << ", " << y;
}

TEST_F(StylizeElement, NeutralSettingsReturnTheFrameAndDispatchNothing) {
  expect_neutral("intrinsicstylize", {"strength=0", "sensitivity=0 levels=0 flatten=0",
                                      "sharpness=0 levels=0 flatten=0"});
}

TEST_F(StylizeElement, EveryPropertyTakesEffectWhilePlaying) {
  VideoHarness harness("intrinsicdecomp ! intrinsicstylize ! intrinsiccompose", rgba(), rgba());
  GstElement* stylize = harness.find("intrinsicstylize");
  harness.process(frame, 2);
  for (const auto& [name, value] : std::vector<std::pair<const char*, float>>{{"scale", 6},
                                                                              {"sensitivity", 5},
                                                                              {"sharpness", 40},
                                                                              {"levels", 3},
                                                                              {"softness", 1},
                                                                              {"flatten", 2},
                                                                              {"strength", .4F}}) {
    const auto before = harness.process(frame);
    g_object_set(stylize, name, double{value}, nullptr);
    EXPECT_GT(largest_difference(harness.process(frame), before), 3) << name;
  }
}

TEST_F(StylizeElement, EveryNumberFollowsAController) {
  for (const auto& [name, from, to] :
       std::vector<std::tuple<const char*, double, double>>{{"scale", .5, 12},
                                                            {"sensitivity", 0, 8},
                                                            {"sharpness", 0, 20},
                                                            {"levels", 2, 9},
                                                            {"softness", 0, 1},
                                                            {"flatten", 0, 2},
                                                            {"strength", 0, 1}}) {
    VideoHarness harness("intrinsicdecomp ! intrinsicstylize sensitivity=4 ! intrinsiccompose",
                         rgba(), rgba());
    ramp(harness.find("intrinsicstylize"), name, from, to);
    const auto first = harness.process(frame);
    harness.process(frame, 22);
    EXPECT_GT(largest_difference(harness.process(frame), first), 5) << name;
    EXPECT_NEAR(double{property<gfloat>(harness.find("intrinsicstylize"), name)},
                from + (to - from) * 23 / 25, .01 * to)
        << name;
  }
}

TEST_F(StylizeElement, AMaskConfinesIt) {
  expect_confined_by_a_mask("intrinsicstylize sensitivity=5");
}

// Frames of one scene that differ by noise of a camera.
TEST_F(StylizeElement, DoesNotFlicker) {
  const auto flicker = [&](const std::string& editor) {
    VideoHarness harness("intrinsicdecomp ! " + editor + "intrinsiccompose", rgba(), rgba());
    std::vector<uint8_t> before;
    double sum = 0;
    for (unsigned n = 0; n < 12; ++n) {
      const auto shown = harness.process(lit_paints(kWidth, kHeight, n));
      if (n > 3)
        for (size_t i = 0; i < shown.size(); ++i)
          sum += (shown[i] - before[i]) * (shown[i] - before[i]);
      before = shown;
    }
    return std::sqrt(sum / (8.0 * kWidth * kHeight * 4));
  };
  const double without = flicker("");
  EXPECT_GT(without, .5);
  EXPECT_LT(flicker("intrinsicstylize ! "), 1.2 * without);
}

TEST_F(StylizeElement, AnyFormatAndSizeWorks) {
  for (const char* scale : {"0.3", "2", "100"})
    expect_any_format_and_size(line(std::string("intrinsicstylize scale=") + scale));
}

TEST_F(StylizeElement, BlackStaysBlack) {
  const std::string caps = VideoHarness::caps("RGB", kWidth, kHeight);
  VideoHarness harness(
      "intrinsicdecomp ! intrinsicstylize sensitivity=100 levels=1 ! "
      "intrinsiccompose",
      caps, caps);
  const auto black = flat_frame(caps, 0);
  EXPECT_LE(largest_difference(harness.process(black, 2), black), 1);
}

}  // namespace inverse::testing
