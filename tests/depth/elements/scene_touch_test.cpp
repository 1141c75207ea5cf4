// SPDX-License-Identifier: LGPL-2.1-or-later
// A hand that touches a remembered scene, by whole lines. The scene is seen for 6 s and then
// frozen; the hand of rgbdtestsrc is there .5 s later, touches from 3 to 4.2 s and has left at 5.5.
#include <gst/video/navigation.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/elements/element_test.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

constexpr int kSeen = 30, kTouches = kSeen + 15, kGone = kSeen + 28;  // frames

/// A line with a hand that touches `hand`; `when(element, n)` is called before frame n is
/// decomposed.
struct Line {
  LineResult result;
  std::string strokes;  ///< the property at the end
  std::array<double, 3> contact{};
  std::vector<guint> blocks;  ///< of the scene, by frame
  std::vector<gboolean> touched;
  guint color = 0;
  gint mode = 0;

  explicit Line(const char* hand, bool touch, const std::string& settings, int frames,
                const std::string& after = "",
                const std::function<void(GstElement*, int)>& when = {}) {
    int n = 0;
    const std::string line =
        "rgbdtestsrc name=source is-live=false samples=1 path=table num-buffers=" +
        std::to_string(frames) +
        " ! video/x-raw,width=320,height=240,framerate=5/1 ! identity name=before ! "
        "intrinsicdecomp name=decomposer show=reflectance " +
        settings + " ! " + after + " video/x-raw,format=RGBA ! appsink name=out sync=false";
    result = run_line(line, 400, [&](GstElement* pipeline) {
      GstElement* element = find_element(pipeline, "decomposer");
      watch_buffers(find_element(pipeline, "before"), "src", [&, element, pipeline](GstBuffer*) {
        if (n == kSeen) {
          gst_util_set_object_arg(G_OBJECT(find_element(pipeline, "source")), "hand", hand);
          gst_child_proxy_set(GST_CHILD_PROXY(element), "scene::update", FALSE, "strokes::touch",
                              touch, nullptr);
        }
        if (when) when(element, n);
        ++n;
      });
      watch_buffers(find_element(pipeline, "out"), "sink", [&, element, pipeline](GstBuffer*) {
        gchar* text = nullptr;
        GstStructure *stats = nullptr, *truth = nullptr;
        gst_child_proxy_get(GST_CHILD_PROXY(element), "strokes::list", &text, "stats", &stats,
                            "strokes::color", &color, "strokes::mode", &mode, nullptr);
        strokes = text ? text : "";
        g_free(text);
        guint count = 0;
        gboolean touches = FALSE;
        if (stats) {
          gst_structure_get_uint(stats, "scene-blocks", &count);
          gst_structure_get_boolean(stats, "scene-touched", &touches);
          gst_structure_free(stats);
        }
        blocks.push_back(count);
        touched.push_back(touches);
        g_object_get(find_element(pipeline, "source"), "stats", &truth, nullptr);
        gst_structure_get(truth, "hand-contact-x", G_TYPE_DOUBLE, &contact[0], "hand-contact-y",
                          G_TYPE_DOUBLE, &contact[1], "hand-contact-z", G_TYPE_DOUBLE, &contact[2],
                          nullptr);
        gst_structure_free(truth);
      });
    });
  }
  long messages(const char* name) const {
    return std::count(result.messages.begin(), result.messages.end(), name);
  }
};

nlohmann::json list_of(const std::string& strokes) {
  const auto json = nlohmann::json::parse(strokes, nullptr, false);
  if (json.is_discarded()) return nlohmann::json::array();
  return json.is_object() ? json["strokes"] : json;
}

TEST(SceneTouch, DrawsOneStrokeWhereItTouches) {
  bool undone = false;
  std::string drawn;
  const Line line("book", true, "strokes::mode=recolor strokes::color=0xff20a040", kGone + 8, "",
                  [&](GstElement* element, int n) {
                    if (n != kGone) return;
                    gchar* text = nullptr;
                    gboolean done = FALSE;
                    gst_child_proxy_get(GST_CHILD_PROXY(element), "strokes::list", &text, nullptr);
                    drawn = text ? text : "";
                    g_free(text);
                    g_signal_emit_by_name(element, "undo-stroke", &done);
                    undone = done;
                  });
  ASSERT_EQ(line.result.frames.size(), size_t(kGone + 8)) << line.result.first_error();
  EXPECT_TRUE(line.result.warnings.empty()) << line.result.warnings.front();
  const auto list = list_of(drawn);
  ASSERT_EQ(list.size(), 1U) << drawn;
  EXPECT_EQ(list[0]["kind"], "recolor");
  EXPECT_EQ(list[0]["color"], "#20a040");
  for (const auto& ball : list[0]["balls"]) {
    double square = 0;
    for (size_t c = 0; c < 3; ++c) square += std::pow(double{ball[c]} - line.contact[c], 2);
    EXPECT_LT(std::sqrt(square), 0.03) << ball;
    EXPECT_NEAR(double{ball[3]}, 12 * 0.65 / 266, 0.02) << "the brush of 12 pixels";
  }
  EXPECT_EQ(line.messages("inverse-touch-began"), 1);
  EXPECT_EQ(line.messages("inverse-touch-ended"), 1);
  EXPECT_TRUE(undone);
  EXPECT_EQ(line.strokes, "") << "one stroke, which is undone as a whole";
}

// Who does not want it gets nothing of it.
TEST(SceneTouch, IsOffAtFirst) {
  const Line line("book", false, "strokes::mode=recolor", kTouches + 8);
  EXPECT_EQ(line.strokes, "");
  EXPECT_EQ(line.messages("inverse-touch-began"), 0);
  EXPECT_EQ(std::count(line.touched.begin(), line.touched.end(), TRUE), 0);
}

// A first touch picks a color up, the next one gives it to another thing (thesis, Fig. 4.9).
TEST(SceneTouch, PicksAColorAndThenPaints) {
  std::string picked = "none";
  const int again = kSeen + 30;
  const Line line("dark-ball", true, "strokes::mode=pick", again + 29, "",
                  [&](GstElement* element, int n) {
                    if (n != again) return;
                    gchar* text = nullptr;
                    gst_child_proxy_get(GST_CHILD_PROXY(element), "strokes::list", &text, nullptr);
                    picked = text ? text : "";
                    g_free(text);
                    GstObject* pipeline = gst_object_get_parent(GST_OBJECT(element));
                    gst_util_set_object_arg(G_OBJECT(find_element(GST_ELEMENT(pipeline), "source")),
                                            "hand", "box");
                    gst_object_unref(pipeline);
                  });
  ASSERT_EQ(line.result.frames.size(), size_t(again + 29)) << line.result.first_error();
  EXPECT_EQ(picked, "") << "the touch that picks draws nothing";
  EXPECT_EQ(line.mode, 3) << "recolor";
  // The ball has the darkest paint of all, and no color; the table around it is brown and cream.
  for (const int shift : {0, 8, 16}) {
    EXPECT_LT(line.color >> shift & 0xffU, 0x88U) << shift;
    EXPECT_NEAR(double(line.color >> shift & 0xffU), double(line.color & 0xffU), 16) << shift;
  }
  EXPECT_EQ(line.color >> 24, 0xffU);
  const auto list = list_of(line.strokes);
  ASSERT_EQ(list.size(), 1U) << line.strokes;
  EXPECT_EQ(std::stoul(list[0]["color"].get<std::string>().substr(1), nullptr, 16),
            line.color & 0xffffffU);
  double square = 0;
  for (size_t c = 0; c < 3; ++c)
    square += std::pow(double{list[0]["balls"][0][c]} - line.contact[c], 2);
  EXPECT_LT(std::sqrt(square), 0.03);
}

TEST(SceneTouch, TheMousePicksAColor) {
  const Line line("none", false, "strokes::mode=pick", 12, "", [](GstElement* element, int n) {
    if (n != 5) return;
    GstPad* pad = gst_element_get_static_pad(element, "src");
    // The blue box at the right.
    gst_pad_send_event(
        pad, gst_navigation_event_new_mouse_button_press(1, 310, 30, GST_NAVIGATION_MODIFIER_NONE));
    gst_object_unref(pad);
  });
  EXPECT_EQ(line.mode, 3) << "recolor";
  EXPECT_EQ(line.strokes, "");
  EXPECT_GT(int(line.color & 0xffU), int(line.color >> 16 & 0xffU) + 40) << std::hex << line.color;
}

// A segment is filled from a touch, and only its shading changes (thesis, 4.8).
TEST(SceneTouch, SelectsForElementsThatFollow) {
  const char* hand = "dark-ball";
  const std::string settings = "strokes::mode=select strokes::fill=true strokes::radius=5";
  const Line plain(hand, true, settings, kGone + 2, "intrinsiccompose !"),
      toned(hand, true, settings, kGone + 2,
            "intrinsictone look=custom curve=\"-5,-1 5,9\" middle=0.3 ! intrinsiccompose !");
  ASSERT_EQ(toned.result.frames.size(), size_t(kGone + 2)) << toned.result.first_error();
  ASSERT_EQ(list_of(toned.strokes).size(), 1U) << toned.strokes;
  const auto changed = [&](size_t n) {
    size_t count = 0;
    for (size_t i = 0; i < plain.result.frames[n].size(); ++i)
      count += std::abs(int{plain.result.frames[n][i]} - int{toned.result.frames[n][i]}) > 8;
    return count;
  };
  EXPECT_EQ(changed(kSeen + 10), 0U) << "nothing is selected before the touch";
  const size_t last = size_t(kGone) + 1, ball = changed(last);
  EXPECT_GT(ball, 500U);
  EXPECT_LT(ball, 3U * 3500U) << "the ball is some 2 000 pixels";
}

TEST(SceneTouch, AFrozenSceneStaysAsItIs) {
  const Line line("none", false, "scene::update=true", 30, "", [](GstElement* element, int n) {
    if (n == 4) gst_child_proxy_set(GST_CHILD_PROXY(element), "scene::update", FALSE, nullptr);
    if (n == 24) gst_child_proxy_set(GST_CHILD_PROXY(element), "scene::update", TRUE, nullptr);
  });
  ASSERT_EQ(line.blocks.size(), 30U) << line.result.first_error();
  EXPECT_TRUE(line.result.warnings.empty());
  EXPECT_GT(line.blocks[8], 100U);
  EXPECT_EQ(line.blocks[8], line.blocks[22]);
  EXPECT_GT(line.blocks[29], line.blocks[22]);
}

TEST(SceneTouch, SaysWhatItNeeds) {
  const Line frozen("none", false, "scene::update=false", 4);
  ASSERT_EQ(frozen.result.warnings.size(), 1U);
  EXPECT_NE(frozen.result.warnings[0].find("scene::load"), std::string::npos);
  EXPECT_EQ(frozen.result.frames.size(), 4U);
  const Line without("none", false, "strokes::touch=true scene::remember=false", 4);
  ASSERT_EQ(without.result.warnings.size(), 1U);
  EXPECT_NE(without.result.warnings[0].find("strokes::touch needs"), std::string::npos);
}

}  // namespace
}  // namespace inverse::testing
