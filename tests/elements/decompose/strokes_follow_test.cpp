// SPDX-License-Identifier: LGPL-2.1-or-later
// Strokes that recolor, strokes on things that move, and strokes that fill a surface.
#include <gst/video/navigation.h>

#include <cmath>

#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/expect_error.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 240, kHeight = 120;

/// A wall of soft stripes, and on it a checkerboard of 60 x 60 pixels whose left edge is at `left`.
std::vector<uint8_t> board_at(int left) {
  return draw(kWidth, kHeight, [left](int x, int y, int c) {
    if (x >= left && x < left + 60 && y >= 30 && y < 90)
      return ((x - left) / 10 + (y - 30) / 10) % 2 ? 75.0 : 215.0;
    return 150.0 + 20 * std::sin(.11 * x + .07 * y + .3 * std::sin(.2 * y)) - 10 * c;
  });
}

/// Two paints in even light.
std::vector<uint8_t> paints() {
  return draw(kWidth, kHeight, [](int x, int y, int c) {
    const bool left = x < 120;
    const double light = .6 + .02 * std::sin(.1 * y);
    return light * (left ? (c == 0 ? 190 : 60) : (c == 2 ? 170 : 90));
  });
}

class MovingStrokes : public ::testing::TestWithParam<const char*> {
 protected:
  explicit MovingStrokes(const char* show = "shading")
      : harness_(std::string(GetParam()) + " show=" + show, caps(), caps()),
        element_(harness_.find(GetParam())) {}
  static std::string caps() { return VideoHarness::caps("RGBA", kWidth, kHeight); }
  void set(const std::string& strokes) {
    gst_child_proxy_set(GST_CHILD_PROXY(element_), "strokes::list", strokes.c_str(), nullptr);
  }
  /// Standard deviation of what is shown, well inside of the board.
  static double spread(const std::vector<uint8_t>& shown, int left) {
    double sum = 0, squares = 0, count = 0;
    for (int y = 40; y < 80; ++y)
      for (int x = left + 10; x < left + 50; ++x) {
        const double value = pixel_at(shown, x, y, kWidth)[0];
        sum += value, squares += value * value, ++count;
      }
    return std::sqrt(std::max(squares / count - std::pow(sum / count, 2), 0.0));
  }
  /// The board moves for 60 frames, 2 pixels each; the mean spread of frames from the fifth on.
  double moving_spread() {
    double sum = 0;
    for (int t = 0; t < 60; ++t) {
      const int left = 20 + 2 * t;
      const double now = spread(harness_.process(board_at(left)), left);
      if (t >= 5) sum += now / 55;
    }
    return sum;
  }
  Structure stats() {
    GstStructure* stats = nullptr;
    g_object_get(element_, "stats", &stats, nullptr);
    return Structure(stats, gst_structure_free);
  }
  std::vector<std::string> states() {
    const auto now = stats();
    std::vector<std::string> result;
    const GValue* list = gst_structure_get_value(now.get(), "stroke-states");
    for (guint i = 0; list && i < gst_value_array_get_size(list); ++i)
      result.emplace_back(g_value_get_string(gst_value_array_get_value(list, i)));
    return result;
  }

  VideoHarness harness_;
  GstElement* element_;
};

const char* const kOnTheBoard = R"([{"kind":"shading","radius":34,"points":[[40,60],[60,60]]}])";

TEST_P(MovingStrokes, KeepTextureOutOfShading) {
  const double without = moving_spread();
  ASSERT_GT(without, 3) << "the picture must be one that is got wrong";
  harness_.flush();
  set(kOnTheBoard);
  EXPECT_LT(moving_spread(), .2 * without);
  EXPECT_EQ(states(), std::vector<std::string>{"followed"});
  gboolean history = FALSE;
  gst_structure_get_boolean(stats().get(), "history", &history);
  EXPECT_TRUE(history) << "a stroke that moves must not restart the solve";
  EXPECT_TRUE(harness_.warnings().empty());
  // After a seek, they are where they were drawn.
  harness_.flush();
  EXPECT_LT(moving_spread(), .2 * without);
  gst_child_proxy_set(GST_CHILD_PROXY(element_), "strokes::follow", FALSE, nullptr);
  harness_.flush();
  EXPECT_GT(moving_spread(), .6 * without);
  EXPECT_TRUE(states().empty());
}

TEST_P(MovingStrokes, AreFilledAgainWhereTheyAre) {
  const auto cloth_at = [](int left) {
    return draw(kWidth, kHeight, [left](int x, int y, int c) {
      const bool cloth = x >= left && x < left + 60 && y >= 30 && y < 90;
      const double stripe = (x - left + y / 3) % 17 < 5 ? .85 : 1;
      if (cloth) return stripe * (c == 0 ? 110 : 38);
      return 190.0 + 20 * std::sin(.11 * x + .07 * y) - 40 * c;
    });
  };
  const auto moving = [&] {
    double sum = 0;
    for (int t = 0; t < 40; ++t) {
      const auto shown = harness_.process(cloth_at(20 + 2 * t));
      if (t >= 5) sum += spread(shown, 20 + 2 * t) / 35;
    }
    return sum;
  };
  gst_util_set_object_arg(G_OBJECT(element_), "show", "reflectance");
  const double without = moving();
  harness_.flush();
  set(R"([{"kind":"reflectance","radius":10,"fill":true,"points":[[50,60]]}])");
  EXPECT_LT(moving(), .7 * without);
}

TEST_P(MovingStrokes, OneThatIsLostIsAWarning) {
  set(kOnTheBoard);
  for (int t = 0; t < 6; ++t) harness_.process(board_at(20));
  EXPECT_EQ(states(), std::vector<std::string>{"followed"});
  for (int t = 0; t < 8; ++t)  // a cut
    harness_.process(draw(kWidth, kHeight, [](int x, int y, int c) {
      return 128.0 + 100 * std::sin(.4 * x + c) * std::sin(.5 * y + .1 * x);
    }));
  EXPECT_EQ(states(), std::vector<std::string>{"lost"});
  expect_one(harness_.warnings(), "not found any more, so that they are not drawn until it is: 1;");
  for (int t = 0; t < 8; ++t) harness_.process(board_at(20));
  EXPECT_EQ(states(), std::vector<std::string>{"followed"});
}

TEST_P(MovingStrokes, TheEraserFindsThem) {
  set(kOnTheBoard);
  for (int t = 0; t < 45; ++t) harness_.process(board_at(20 + 2 * t));
  set_text(element_, "strokes::mode", "erase");
  const auto press = [&](double x) {
    harness_.send_upstream(
        gst_navigation_event_new_mouse_button_press(1, x, 60, GST_NAVIGATION_MODIFIER_NONE));
  };
  press(30);  // where it was drawn
  EXPECT_NE(property<std::string>(element_, "strokes::list"), "");
  press(150);
  EXPECT_EQ(property<std::string>(element_, "strokes::list"), "");
}

INSTANTIATE_TEST_SUITE_P(Elements, MovingStrokes,
                         ::testing::Values("intrinsicdecomp", "globalintrinsic"));

/// The baseline starts each frame anew, so that what others need a history for is not asked of it.
class ThesisStrokes : public MovingStrokes {};

TEST_P(ThesisStrokes, MoveWithWhatTheyLieOn) {
  const auto moving = [&] {
    double sum = 0;
    for (int t = 0; t < 12; ++t) sum += spread(harness_.process(board_at(20 + 4 * t)), 20 + 4 * t);
    return sum / 12;
  };
  const double without = moving();
  ASSERT_GT(without, 3) << "the picture must be one that is got wrong";
  harness_.flush();
  set(kOnTheBoard);
  EXPECT_LT(moving(), .2 * without);
  EXPECT_EQ(states(), std::vector<std::string>{"followed"});
  EXPECT_TRUE(harness_.warnings().empty());
}

TEST_P(ThesisStrokes, FillTheirSurface) {
  // The ripple of light on one paint, far from the dot.
  const auto ripple = [&](const char* strokes) {
    harness_.flush();
    set(strokes);
    return spread(harness_.process(paints(), 3), 10);
  };
  const double dot = ripple(R"([{"kind":"shading","radius":5,"points":[[100,60]]}])"),
               filled =
                   ripple(R"([{"kind":"shading","radius":5,"fill":true,"points":[[100,60]]}])");
  EXPECT_GT(dot, 1);
  EXPECT_LT(filled, .3 * dot);
}

INSTANTIATE_TEST_SUITE_P(Elements, ThesisStrokes, ::testing::Values("intrinsicdecompthesis"));

class RecolorStrokes : public MovingStrokes {
 protected:
  RecolorStrokes() : MovingStrokes("reflectance") {}
  std::vector<uint8_t> settled() { return harness_.process(paints(), 6); }
};

TEST_P(RecolorStrokes, ChangeReflectanceAlone) {
  const auto before = settled();
  set(R"([{"kind":"recolor","color":"#20c040","radius":20,"points":[[40,60],[80,60]]}])");
  const auto after = harness_.process(paints());
  gboolean history = FALSE;
  gst_structure_get_boolean(stats().get(), "history", &history);
  EXPECT_TRUE(history) << "the solve must not restart";
  const uint8_t* inside = pixel_at(after, 60, 60, kWidth);
  EXPECT_NEAR(inside[0], 0x20, 1);
  EXPECT_NEAR(inside[1], 0xc0, 1);
  EXPECT_NEAR(inside[2], 0x40, 1);
  const auto outside = [](const std::vector<uint8_t>& frame) {
    return std::vector<uint8_t>(pixel_at(frame, 0, 100, kWidth), pixel_at(frame, 0, 119, kWidth));
  };
  EXPECT_LE(largest_difference(outside(before), outside(after)), 1);
  gst_util_set_object_arg(G_OBJECT(element_), "show", "shading");
  const auto shading = harness_.process(paints());
  set("");
  EXPECT_LE(largest_difference(shading, harness_.process(paints())), 2) << "shading stays";
  gst_util_set_object_arg(G_OBJECT(element_), "show", "reflectance");
  EXPECT_LE(largest_difference(before, settled()), 2);
}

TEST_P(RecolorStrokes, FillTheirSurface) {
  settled();
  set(R"([{"kind":"recolor","color":"#20c040","radius":8,"fill":true,"points":[[60,60]]}])");
  const auto after = settled();
  for (const auto& [x, y] : {std::pair{10, 10}, {100, 100}, {60, 20}}) {
    const uint8_t* pixel = pixel_at(after, x, y, kWidth);
    EXPECT_GT(pixel[1], pixel[0] + 60) << x << "," << y;
  }
  EXPECT_GT(pixel_at(after, 180, 60, kWidth)[2], pixel_at(after, 180, 60, kWidth)[1] + 20);
}

TEST_P(RecolorStrokes, GoThroughEditorsAndCompose) {
  VideoHarness harness(
      std::string(GetParam()) + " ! intrinsicrecolor strength=0 ! intrinsiccompose", caps(),
      caps());
  GstElement* decomposer = harness.find(GetParam());
  const auto before = harness.process(paints(), 4);
  EXPECT_EQ(largest_difference(before, paints()), 0);
  gst_child_proxy_set(
      GST_CHILD_PROXY(decomposer), "strokes::list",
      R"([{"kind":"recolor","color":"#20c040","radius":20,"points":[[40,60],[80,60]]}])", nullptr);
  const auto after = harness.process(paints(), 4);
  const uint8_t* inside = pixel_at(after, 60, 60, kWidth);
  EXPECT_GT(inside[1], inside[0] + 40);
  EXPECT_GT(inside[1], inside[2] + 40);
  EXPECT_TRUE(harness.errors().empty());
}

TEST_P(RecolorStrokes, AreDrawnInTheirColor) {
  settled();
  set_text(element_, "strokes::mode", "recolor");
  gst_child_proxy_set(GST_CHILD_PROXY(element_), "strokes::color", 0xff12ab34U, nullptr);
  harness_.send_upstream(
      gst_navigation_event_new_mouse_button_press(1, 50, 50, GST_NAVIGATION_MODIFIER_NONE));
  harness_.send_upstream(
      gst_navigation_event_new_mouse_button_release(1, 50, 50, GST_NAVIGATION_MODIFIER_NONE));
  EXPECT_EQ(
      property<std::string>(element_, "strokes::list"),
      R"({"frame":[240,120],"strokes":[{"kind":"recolor","color":"#12ab34","radius":12.0,"points":[[50.0,50.0]]}]})");
  for (const auto& [text, part] : std::initializer_list<std::pair<std::string, std::string>>{
           {R"([{"kind":"recolor","points":[[1,2]]}])", "must have a color"},
           {R"([{"kind":"shading","color":"#102030","points":[[1,2]]}])", "no color"},
           {R"([{"kind":"recolor","color":"red","points":[[1,2]]}])", "#rrggbb"},
           {R"([{"kind":"recolor","color":"#12345g","points":[[1,2]]}])", "#rrggbb"},
           {R"([{"kind":"recolor","color":7,"points":[[1,2]]}])", "#rrggbb"}}) {
    set(text);
    expect_one(harness_.warnings(), part);
  }
}

INSTANTIATE_TEST_SUITE_P(Elements, RecolorStrokes,
                         ::testing::Values("intrinsicdecomp", "globalintrinsic"));

}  // namespace
}  // namespace inverse::testing
