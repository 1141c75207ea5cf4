// SPDX-License-Identifier: LGPL-2.1-or-later
// Strokes of decomposers: by property, signals and mouse.
#include <gst/video/navigation.h>

#include <cmath>
#include <thread>
#include <vector>

#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/expect_error.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 160, kHeight = 120;

/// A checkerboard under even light.
std::vector<uint8_t> board() {
  return draw(kWidth, kHeight, [](int x, int y, int) {
    const bool inside = x > 30 && x < 130 && y > 20 && y < 100;
    return !inside ? 170.0 : (x / 10 + y / 10) % 2 ? 75.0 : 215.0;
  });
}

const char* const kOverTheBoard = R"([{"kind":"shading","radius":32,"points":[[50,60],[110,60]]}])";

class Strokes : public ::testing::TestWithParam<const char*> {
 protected:
  /// Standard deviation of shading, in code values, well inside of the stroke.
  double texture() {
    std::vector<uint8_t> shown;
    for (int i = 0; i < 4; ++i) shown = harness_.process(frame_);
    double sum = 0, squares = 0, count = 0;
    for (int y = 40; y < 80; ++y)
      for (int x = 45; x < 115; ++x) {
        const double value = pixel_at(shown, x, y, kWidth)[0];
        sum += value, squares += value * value, ++count;
      }
    return std::sqrt(squares / count - std::pow(sum / count, 2));
  }
  void set(const std::string& strokes) {
    gst_child_proxy_set(GST_CHILD_PROXY(element_), "strokes::list", strokes.c_str(), nullptr);
  }
  std::string strokes() { return property<std::string>(element_, "strokes::list"); }
  void set_mode(const char* mode) { set_text(element_, "strokes::mode", mode); }
  void press(double x, double y) {
    harness_.send_upstream(
        gst_navigation_event_new_mouse_button_press(1, x, y, GST_NAVIGATION_MODIFIER_NONE));
  }
  void move(double x, double y) {
    harness_.send_upstream(gst_navigation_event_new_mouse_move(x, y, GST_NAVIGATION_MODIFIER_NONE));
  }
  void release(double x, double y) {
    harness_.send_upstream(
        gst_navigation_event_new_mouse_button_release(1, x, y, GST_NAVIGATION_MODIFIER_NONE));
  }
  template <typename... Arguments>
  bool call(const char* action, Arguments... arguments) {
    gboolean done = FALSE;
    g_signal_emit_by_name(element_, action, arguments..., &done);
    return done;
  }

  const std::vector<uint8_t> frame_ = board();
  const std::string caps_ = VideoHarness::caps("RGBA", kWidth, kHeight);
  VideoHarness harness_{std::string(GetParam()) + " show=shading", caps_, caps_};
  GstElement* element_ = harness_.find(GetParam());
};

TEST_P(Strokes, TextureLeavesShadingAndComesBack) {
  const double before = texture();
  ASSERT_GT(before, 15) << "the picture must be one that is got wrong";
  set(kOverTheBoard);
  EXPECT_LT(texture(), .1 * before);
  GstStructure* stats = nullptr;
  g_object_get(element_, "stats", &stats, nullptr);
  const GValue* list = gst_structure_get_value(stats, "strokes");
  ASSERT_TRUE(list && gst_value_array_get_size(list) == 1);
  EXPECT_LT(g_value_get_double(gst_value_array_get_value(list, 0)), .05);
  gst_structure_free(stats);
  set("");
  EXPECT_GT(texture(), .9 * before);
  EXPECT_TRUE(harness_.warnings().empty());
}

TEST_P(Strokes, AreDrawnRemovedAndUndone) {
  press(50, 60);  // before the first frame: ignored
  const double before = texture();
  press(50, 60);  // strokes::mode=off
  release(110, 60);
  EXPECT_EQ(strokes(), "");
  set_mode("shading");
  gst_child_proxy_set(GST_CHILD_PROXY(element_), "strokes::radius", 32.0F, nullptr);
  press(50, 60);
  for (int x = 50; x <= 110; x += 2) move(x, 60);
  EXPECT_EQ(strokes(), "");
  EXPECT_LT(texture(), .1 * before) << "it must be seen while it is drawn";
  release(110, 60);
  const std::string drawn = strokes();
  expect_contains(drawn, R"("kind":"shading","radius":32.0,"points":[[50.0,60.0],)");
  expect_contains(drawn, R"("frame":[160,120])");
  EXPECT_LT(texture(), .1 * before);
  move(10, 10);  // with no button down
  EXPECT_EQ(strokes(), drawn);

  set_mode("erase");
  press(10, 10);  // no stroke is there
  EXPECT_EQ(strokes(), drawn);
  press(80, 70);
  EXPECT_EQ(strokes(), "");
  EXPECT_GT(texture(), .9 * before);
  EXPECT_TRUE(call("undo-stroke"));
  EXPECT_EQ(strokes(), drawn);
  EXPECT_TRUE(call("undo-stroke"));
  EXPECT_EQ(strokes(), "");
  EXPECT_FALSE(call("undo-stroke"));
  expect_one(harness_.warnings(), "undo");

  EXPECT_TRUE(call("add-stroke", R"({"kind":"reflectance","points":[[5,5]]})"));
  EXPECT_TRUE(call("add-stroke", R"({"kind":"shading","radius":3,"points":[[9,9],[20,20]]})"));
  EXPECT_FALSE(call("remove-stroke", 3U));
  EXPECT_FALSE(call("remove-stroke", 0U));
  EXPECT_TRUE(call("remove-stroke", 1U));
  EXPECT_EQ(
      strokes(),
      R"({"frame":[160,120],"strokes":[{"kind":"shading","radius":3.0,"points":[[9.0,9.0],[20.0,20.0]]}]})");
  EXPECT_TRUE(call("clear-strokes"));
  EXPECT_EQ(strokes(), "");
  EXPECT_EQ(harness_.warnings().size(), 2U);
  set_mode("reflectance");
  gst_child_proxy_set(GST_CHILD_PROXY(element_), "strokes::fill", TRUE, nullptr);
  press(3, 4);
  release(3, 4);
  EXPECT_EQ(
      strokes(),
      R"({"frame":[160,120],"strokes":[{"kind":"reflectance","radius":32.0,"fill":true,"points":[[3.0,4.0]]}]})");
}

TEST_P(Strokes, BadOnesAreRefusedInWords) {
  texture();
  for (const auto& [text, part] : std::initializer_list<std::pair<std::string, std::string>>{
           {"[", "JSON"},
           {"7", "list"},
           {"{}", "list"},
           {R"([{"points":[[1,2]]}])", "kind"},
           {R"([{"kind":"light","points":[[1,2]]}])", "kind"},
           {R"([{"kind":"shading"}])", "points"},
           {R"([{"kind":"shading","points":[]}])", "points"},
           {R"([{"kind":"shading","points":[[1]]}])", "pairs"},
           {R"([{"kind":"shading","points":[[1,"2"]]}])", "y of a point"},
           {R"([{"kind":"shading","points":[[1e9,2]]}])", "x of a point"},
           {R"([{"kind":"shading","radius":0,"points":[[1,2]]}])", "radius"},
           {R"([{"kind":"shading","fill":1,"points":[[1,2]]}])", "fill"},
           {R"([{"kind":"shading","width":3,"points":[[1,2]]}])", "width"},
           {R"({"frame":[0,3],"strokes":[]})", "width"},
           {std::string(1000, '['), "deep"}}) {
    set(text);
    expect_one(harness_.warnings(), part);
    EXPECT_FALSE(call("add-stroke", text.c_str())) << text;
    harness_.warnings();
  }
  EXPECT_EQ(strokes(), "") << "the value before stays in force";
  std::string many = "[";
  for (int i = 0; i < 65; ++i)
    many += std::string(i ? "," : "") + R"({"kind":"shading","points":[[1,2]]})";
  set(many + "]");
  expect_one(harness_.warnings(), "strokes::list: there are 65 strokes; at most 64");
}

TEST_P(Strokes, MessagesNameThePropertyThePlaceAndTheLimit) {
  for (const auto& [text, part] : std::initializer_list<std::pair<std::string, std::string>>{
           {R"([{"kind":"shading","points":[]}])", "strokes::list: stroke 1 must have points"},
           {R"([{"kind":"shading","radius":0,"points":[[1,2]]}])",
            "strokes::list: the radius of stroke 1 must be a number from 0.1 to 10000"},
           {R"([{"kind":"shading","balls":[[1,2,3]]}])",
            "strokes::list: the balls of stroke 1 must be like this: [[x, y, z, radius], ...]"},
           {R"([{"kind":"shading","balls":[[1,2,3,0]]}])",
            "strokes::list: the radius of a ball of stroke 1 must be a number from 0.001 to 100"},
           {R"([{"kind":"shading","balls":[]}])",
            "strokes::list: the balls of stroke 1 must be a list"},
           {R"([{"kind":"shading","radius":1,"balls":[[1,2,3,1]]}])",
            "strokes::list: stroke 1 lies in the scene by its balls; leave out points and radius"},
           {"[\n {\"kind\" ]", "strokes::list: the text is not valid JSON at line 2, column 10"},
           {"[1e999]", "strokes::list: the text is not valid JSON at character 6"}}) {
    set(text);
    expect_one(harness_.warnings(), part);
  }
  std::string points = "[[1,2]";
  for (int i = 0; i < 4096; ++i) points += ",[1,2]";
  set(R"([{"kind":"shading","points":)" + points + "]}]");
  expect_one(harness_.warnings(), "stroke 1 has 4097 points; at most 4096 are possible");
  for (const int count : {1 << 20, 8 << 20}) {
    std::string values = "[1";
    for (int i = 0; i < count; ++i) values += ",1";
    set(values + "]");
    expect_one(harness_.warnings(), "64 strokes of 4096 points");
  }
}

TEST_P(Strokes, OnesWithoutEffectAreOneWarningEach) {
  texture();
  set(R"([{"kind":"shading","points":[[5000,5000]]},{"kind":"shading","points":[[50,60]]},
          {"kind":"recolor","color":"#ff0000","points":[[-90,9]]}])");
  texture();
  texture();
  expect_one(harness_.warnings(), "strokes 1, 3: ", "outside of the frame of 160x120 pixels");
  set(R"([{"kind":"shading","radius":9,"points":[[50,60],[90,60]]},
          {"kind":"reflectance","radius":9,"points":[[50,60],[90,60]]}])");
  texture();
  expect_one(harness_.warnings(), "stroke 1: ", "cover all of it");
  set(R"([{"kind":"shading","radius":9,"points":[[50,60],[90,60]]},
          {"kind":"reflectance","radius":9,"points":[[50,60],[70,60]]}])");
  texture();
  EXPECT_TRUE(harness_.warnings().empty());
}

TEST_P(Strokes, WrongOnesBeforeTheStartAreOneError) {
  const auto result =
      run_line("videotestsrc num-buffers=1 ! " + std::string(GetParam()) + " name=it ! fakesink",
               60, [](GstElement* pipeline) {
                 GstElement* it = gst_bin_get_by_name(GST_BIN(pipeline), "it");
                 gst_child_proxy_set(GST_CHILD_PROXY(it), "strokes::list", "[", nullptr);
                 gst_object_unref(it);
               });
  expect_one(result.errors, "strokes::list: ");
  EXPECT_TRUE(result.warnings.empty());
}

TEST_P(Strokes, TheMouseDrawsNoMoreThanThereIsRoomFor) {
  texture();
  set_mode("reflectance");
  gst_child_proxy_set(GST_CHILD_PROXY(element_), "strokes::radius", 1.0F, nullptr);
  for (int i = 0; i < 66; ++i) {
    press(i, 0);
    release(i, 20);
  }
  texture();
  const auto warned = harness_.warnings();
  ASSERT_FALSE(warned.empty());
  expect_contains(warned.front(), "64");
  EXPECT_TRUE(call("clear-strokes"));
  press(0, 0);
  std::thread mover([&] {
    for (int i = 0; i < 100000; ++i) move(i % 160, i % 120);
    move(NAN, INFINITY);
    move(-1e300, 1e300);
  });
  texture();
  mover.join();
  release(3, 3);
  texture();
  expect_one(harness_.warnings(), "4096");
}

TEST_P(Strokes, NoneIsLostIfSeveralThreadsDraw) {
  texture();
  std::vector<std::thread> threads;
  for (int k = 0; k < 3; ++k)
    threads.emplace_back([this] {
      for (int i = 0; i < 20; ++i) call("add-stroke", R"({"kind":"shading","points":[[5,5]]})");
    });
  for (std::thread& thread : threads) thread.join();
  const std::string text = strokes();
  size_t count = 0;
  for (size_t at = 0; (at = text.find("points", at)) != std::string::npos; ++at) ++count;
  EXPECT_EQ(count, 60U);
  for (int i = 0; i < 60; ++i) EXPECT_TRUE(call("undo-stroke")) << i;
  EXPECT_EQ(strokes(), "");
}

TEST_P(Strokes, OneThatIsCutInPartsIsAWarning) {
  if (std::string(GetParam()) == "intrinsicdecompthesis")
    GTEST_SKIP() << "one mean holds all parts of a stroke (4.7), so that it is satisfied";
  const auto halves = [](int t) {
    return draw(kWidth, kHeight,
                [t](int x, int y, int) { return (x < 80 ? 40.0 : 220.0) + (x + y + t) % 3; });
  };
  // Across the border of light; the second stroke, on that border, separates its two parts.
  set(R"([{"kind":"shading","radius":12,"points":[[40,60],[120,60]]},
          {"kind":"reflectance","radius":8,"points":[[80,0],[80,120]]}])");
  for (int t = 0; t < 30; ++t) harness_.process(halves(t));
  expect_one(harness_.warnings(), "stroke 1 of constant shading is not satisfied");
  set(R"([{"kind":"shading","radius":12,"points":[[40,60],[120,60]]}])");
  for (int t = 0; t < 30; ++t) harness_.process(halves(t));
  EXPECT_TRUE(harness_.warnings().empty());
}

TEST_P(Strokes, AFlushForgetsTheOneThatIsDrawn) {
  const double before = texture();
  set_mode("shading");
  gst_child_proxy_set(GST_CHILD_PROXY(element_), "strokes::radius", 32.0F, nullptr);
  press(50, 60);
  move(110, 60);
  EXPECT_LT(texture(), .3 * before);
  harness_.flush();
  EXPECT_GT(texture(), .9 * before);
  release(110, 60);
  EXPECT_EQ(strokes(), "");
}

TEST_P(Strokes, DroppedFramesLeaveTheOneThatIsDrawn) {
  texture();
  set_mode("shading");
  press(50, 60);
  move(80, 60);
  harness_.push_after_gap(frame_, 60 * GST_SECOND);
  release(110, 60);
  expect_contains(strokes(), R"("points":[[50.0,60.0],)");
}

TEST_P(Strokes, KeepTheirPlaceInAnotherSize) {
  texture();
  set(R"({"frame":[80,60],"strokes":[{"kind":"shading","radius":16,"points":[[25,30],[55,30]]}]})");
  EXPECT_LT(texture(), 3);
}

INSTANTIATE_TEST_SUITE_P(Elements, Strokes,
                         ::testing::Values("intrinsicdecomp", "globalintrinsic",
                                           "intrinsicdecompthesis"));

}  // namespace
TEST(StrokesChild, MayOutliveItsElement) {
  GstElement* element = gst_element_factory_make("intrinsicdecomp", nullptr);
  GObject* child = gst_child_proxy_get_child_by_name(GST_CHILD_PROXY(element), "strokes");
  ASSERT_NE(child, nullptr);
  g_object_set(child, "radius", 20.0F, nullptr);
  EXPECT_EQ(property<float>(element, "strokes::radius"), 20);
  gst_object_unref(element);
  float radius = 0;
  g_object_set(child, "radius", 30.0F, nullptr);
  g_object_get(child, "radius", &radius, nullptr);
  EXPECT_EQ(radius, 12) << "the default";
  g_object_unref(child);
}

}  // namespace inverse::testing
