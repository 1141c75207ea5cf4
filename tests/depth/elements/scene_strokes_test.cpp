// SPDX-License-Identifier: LGPL-2.1-or-later
// Strokes that are put into a remembered scene, by whole lines.
#include <gst/video/navigation.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gst/depth/meta/depth_meta.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/pipeline.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr const char* kRecolor =
    R"([{"kind":"recolor","color":"#ff00ff","radius":7,"points":[[80,75]]}])";

/// The camera of a frame.
struct Seen {
  GstInverseDepthMeta meta;
  std::vector<uint16_t> depth;
};

/// A line with strokes; `when(element, n)` is called before frame n is decomposed.
struct Line {
  LineResult result;
  std::vector<Seen> seen;
  std::string strokes;  ///< the property at the end
  std::vector<std::string> states;

  explicit Line(const std::string& source, const std::string& settings, int frames,
                const std::function<void(GstElement*, int)>& when = {}) {
    int n = 0;
    const std::string line =
        "rgbdtestsrc is-live=false samples=1 num-buffers=" + std::to_string(frames) + " " + source +
        " ! video/x-raw,width=160,height=120 ! identity name=before ! intrinsicdecomp "
        "name=decomposer " +
        settings + " ! video/x-raw,format=RGBA ! appsink name=out sync=false";
    result = run_line(line, 240, [&](GstElement* pipeline) {
      GstElement* element = find_element(pipeline, "decomposer");
      watch_buffers(find_element(pipeline, "before"), "src", [&, element](GstBuffer* buffer) {
        if (when) when(element, n);
        ++n;
        GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer);
        if (!meta) return;
        seen.push_back({*meta, std::vector<uint16_t>(size_t{meta->width} * meta->height)});
        gst_buffer_extract(meta->depth, 0, seen.back().depth.data(), 2 * seen.back().depth.size());
      });
      watch_buffers(find_element(pipeline, "out"), "sink", [&, element](GstBuffer*) {
        gchar* text = nullptr;
        GstStructure* stats = nullptr;
        gst_child_proxy_get(GST_CHILD_PROXY(element), "strokes::list", &text, "stats", &stats,
                            nullptr);
        strokes = text ? text : "";
        g_free(text);
        if (!stats) return;
        states.clear();
        const GValue* list = gst_structure_get_value(stats, "stroke-states");
        for (guint i = 0; list && i < gst_value_array_get_size(list); ++i)
          states.emplace_back(g_value_get_string(gst_value_array_get_value(list, i)));
        gst_structure_free(stats);
      });
    });
  }
};

/// Places of the first stroke of the property.
std::vector<std::array<double, 3>> places_of(const std::string& strokes) {
  const auto json = nlohmann::json::parse(strokes, nullptr, false);
  if (json.is_discarded()) return {};
  const auto& list = json.is_object() ? json["strokes"] : json;
  std::vector<std::array<double, 3>> places;
  if (list.empty() || !list[0].contains("balls")) return {};
  for (const auto& ball : list[0]["balls"]) places.push_back({ball[0], ball[1], ball[2]});
  return places;
}

/// Frames in which a place of the world is seen, and in how many of these it has the color of
/// kRecolor.
struct Visible {
  int frames = 0, colored = 0;
};
Visible visible(const Line& line, const std::array<double, 3>& place, size_t first) {
  Visible result;
  for (size_t n = first; n < line.result.frames.size(); ++n) {
    const GstInverseDepthMeta& meta = line.seen[n].meta;
    std::array<double, 3> p{};
    for (size_t c = 0; c < 3; ++c)
      for (size_t k = 0; k < 3; ++k)
        p[c] += meta.pose[4 * k + c] * (place[k] - meta.pose[4 * k + 3]);
    if (p[2] < 0.2) continue;
    const int x = int(std::lround(meta.fx * p[0] / p[2] + meta.cx)),
              y = int(std::lround(meta.fy * p[1] / p[2] + meta.cy));
    if (x < 3 || y < 3 || x >= kWidth - 3 || y >= kHeight - 3) continue;
    const double depth = meta.unit * line.seen[n].depth[size_t(y) * kWidth + size_t(x)];
    if (std::abs(depth - p[2]) > 0.04) continue;
    const uint8_t* pixel = &line.result.frames[n][4 * (size_t(y) * kWidth + size_t(x))];
    ++result.frames;
    result.colored += pixel[0] > 200 && pixel[1] < 90 && pixel[2] > 200;
  }
  return result;
}

void set(GstElement* element, const char* strokes) {
  gst_child_proxy_set(GST_CHILD_PROXY(element), "strokes::list", strokes, nullptr);
}
void click(GstElement* element, double x, double y) {
  GstPad* pad = gst_element_get_static_pad(element, "src");
  for (GstEvent* event :
       {gst_navigation_event_new_mouse_button_press(1, x, y, GST_NAVIGATION_MODIFIER_NONE),
        gst_navigation_event_new_mouse_button_release(1, x, y, GST_NAVIGATION_MODIFIER_NONE)})
    gst_pad_send_event(pad, event);
  gst_object_unref(pad);
}

// Recolors one place of the room from all sides.
TEST(SceneStrokes, StayOnTheirSurface) {
  const Line line("speed=3", "show=reflectance", 90, [](GstElement* element, int n) {
    if (n == 0) set(element, kRecolor);
  });
  ASSERT_EQ(line.result.frames.size(), 90U) << line.result.first_error();
  EXPECT_TRUE(line.result.warnings.empty()) << line.result.warnings.front();
  const auto places = places_of(line.strokes);
  ASSERT_FALSE(places.empty()) << line.strokes;
  EXPECT_EQ(line.states, std::vector<std::string>{"in-scene"});
  const Visible seen = visible(line, places[0], 10);
  EXPECT_GT(seen.frames, 50);
  EXPECT_GE(seen.colored, seen.frames * 95 / 100) << "of " << seen.frames;
}

// The text that has a stroke in the scene brings it back in another stream of that scene.
TEST(SceneStrokes, AreTheSameInAnotherStream) {
  const Line drawn("", "show=reflectance", 12, [](GstElement* element, int n) {
    if (n == 0) set(element, kRecolor);
  });
  const auto places = places_of(drawn.strokes);
  ASSERT_FALSE(places.empty()) << drawn.strokes;
  const Line again("speed=3", "show=reflectance", 40, [&](GstElement* element, int n) {
    if (n == 0) set(element, drawn.strokes.c_str());
  });
  EXPECT_EQ(again.strokes, drawn.strokes);
  const Visible seen = visible(again, places[0], 3);
  EXPECT_GT(seen.frames, 20);
  EXPECT_GE(seen.colored, seen.frames * 95 / 100) << "of " << seen.frames;
}

TEST(SceneStrokes, ChangesAreUndone) {
  std::string first, both, undone;
  const auto text_of = [](GstElement* element) {
    gchar* text = nullptr;
    gst_child_proxy_get(GST_CHILD_PROXY(element), "strokes::list", &text, nullptr);
    const std::string result = text ? text : "";
    g_free(text);
    return result;
  };
  const Line line("", "", 40, [&](GstElement* element, int n) {
    gboolean done = FALSE;
    const auto add = [&](const char* stroke) {
      g_signal_emit_by_name(element, "add-stroke", stroke, &done);
    };
    const auto undo = [&] { g_signal_emit_by_name(element, "undo-stroke", &done); };
    if (n == 1) add(R"({"kind":"reflectance","radius":6,"points":[[80,75]]})");
    // Before the first one is in the scene.
    if (n == 2) add(R"({"kind":"shading","radius":6,"points":[[30,30]]})");
    if (n == 20) both = text_of(element);
    if (n == 20) undo();
    if (n == 25) first = text_of(element);
    if (n == 25) undo();
    if (n == 30) undone = text_of(element);
  });
  ASSERT_EQ(line.result.frames.size(), 40U) << line.result.first_error();
  EXPECT_FALSE(places_of(both).empty()) << both;
  ASSERT_FALSE(places_of(first).empty()) << first;
  EXPECT_EQ(places_of(first), places_of(both)) << "it is where it was drawn";
  EXPECT_EQ(both.find("shading") == std::string::npos, false);
  EXPECT_EQ(first.find("shading"), std::string::npos);
  EXPECT_EQ(undone, "");
}

TEST(SceneStrokes, AreErasedWhereTheyAreSeen) {
  const Line line("path=still", "show=reflectance", 24, [](GstElement* element, int n) {
    if (n == 0) set(element, kRecolor);
    if (n == 12) gst_child_proxy_set(GST_CHILD_PROXY(element), "strokes::mode", 4, nullptr);
    if (n == 14) click(element, 5, 5);
    if (n == 18) click(element, 80, 75);
  });
  ASSERT_EQ(line.result.frames.size(), 24U) << line.result.first_error();
  EXPECT_EQ(line.strokes, "");
  const auto red = [&](size_t n) {
    return int{line.result.frames[n][4 * (75 * size_t{kWidth} + 80)]} -
           int{line.result.frames[n][4 * (75 * size_t{kWidth} + 80) + 1]};
  };
  EXPECT_GT(red(16), 100) << "a click beside it leaves it";
  EXPECT_LT(red(23), 100);
}

// Without depth they have no effect, which is said once.
TEST(SceneStrokes, NeedAScene) {
  const Line line("", "show=reflectance scene::remember=false", 6, [](GstElement* element, int n) {
    if (n == 0) set(element, R"([{"kind":"shading","fill":true,"balls":[[0,0,1.5,0.1]]}])");
  });
  EXPECT_EQ(line.result.frames.size(), 6U) << line.result.first_error();
  ASSERT_EQ(line.result.warnings.size(), 1U);
  EXPECT_NE(line.result.warnings[0].find("have no effect"), std::string::npos);
  EXPECT_EQ(line.states, std::vector<std::string>{"outside"});
}

// A scene's file has the strokes in it; a line that loads it adds them to its own.
TEST(SceneStrokes, AreSavedAndLoadedWithTheScene) {
  const TemporaryFolder folder;
  const std::string file = folder / "room.scene";
  const Line made("", "scene::location=" + file, 14, [](GstElement* element, int n) {
    if (n == 0) set(element, kRecolor);
  });
  ASSERT_TRUE(made.result.eos) << made.result.first_error();
  const auto places = places_of(made.strokes);
  ASSERT_FALSE(places.empty()) << made.strokes;
  const Line alone("", "scene::load=" + file, 16);
  EXPECT_TRUE(alone.result.warnings.empty()) << alone.result.warnings[0];
  EXPECT_EQ(places_of(alone.strokes), places) << alone.strokes;
  EXPECT_EQ(alone.states, std::vector<std::string>{"in-scene"});
  // What is there already is not there twice; others stay, also those that are undone.
  const Line both("", "scene::load=" + file, 12, [&](GstElement* element, int n) {
    gboolean done = FALSE;
    if (n == 0) set(element, made.strokes.c_str());
    const char* other = R"({"kind":"select","balls":[[0,0.3,0.2,0.05]]})";
    if (n == 1) g_signal_emit_by_name(element, "add-stroke", other, &done);
    if (n == 9) g_signal_emit_by_name(element, "undo-stroke", &done);
  });
  EXPECT_EQ(both.strokes, made.strokes);
}

}  // namespace
}  // namespace inverse::testing
