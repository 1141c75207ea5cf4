// SPDX-License-Identifier: LGPL-2.1-or-later
// Lamps that stand in a remembered scene, by whole lines.
#include <gst/video/navigation.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "gst/depth/meta/depth_meta.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 160, kHeight = 120;

/// The camera of a frame.
struct Seen {
  GstInverseDepthMeta meta;
  std::vector<uint16_t> depth;
};

/// A line with lamps; `when(element, n)` is called before frame n comes to it.
struct Line {
  LineResult result;
  std::vector<Seen> seen;
  std::string lamps;  ///< the property at the end

  explicit Line(const std::string& source, const std::string& settings, int frames,
                const std::function<void(GstElement*, int)>& when = {},
                const std::string& decomposer = "intrinsicdecomp quality=low") {
    int n = 0;
    const std::string line =
        "rgbdtestsrc is-live=false samples=1 num-buffers=" + std::to_string(frames) + " " + source +
        " ! video/x-raw,width=160,height=120 ! identity name=before ! " + decomposer +
        " ! intrinsicrelight name=relight " + settings +
        " ! intrinsiccompose ! video/x-raw,format=RGBA ! appsink name=out sync=false";
    result = run_line(line, 240, [&](GstElement* pipeline) {
      GstElement* element = find_element(pipeline, "relight");
      watch_buffers(find_element(pipeline, "before"), "src", [&](GstBuffer* buffer) {
        GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer);
        if (!meta) return;
        seen.push_back({*meta, std::vector<uint16_t>(size_t{meta->width} * meta->height)});
        gst_buffer_extract(meta->depth, 0, seen.back().depth.data(), 2 * seen.back().depth.size());
      });
      watch_buffers(element, "sink", [&, element](GstBuffer*) {
        if (when) when(element, n);
        ++n;
      });
      watch_buffers(find_element(pipeline, "out"), "sink", [&, element](GstBuffer*) {
        gchar* text = nullptr;
        g_object_get(element, "lamps", &text, nullptr);
        lamps = text ? text : "";
        g_free(text);
      });
    });
  }
};

/// Linear light of a pixel, mean of its channels.
double light_at(const std::vector<uint8_t>& frame, size_t n) {
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) sum += std::pow(frame[4 * n + c] / 255.0, 2.2) / 3;
  return sum;
}

/// Above the middle of the table of the virtual room.
constexpr const char* kOverTable =
    R"(lamps="[{\"kind\":\"point\",\"position\":[0,-0.9,0.1],\"power\":1.5,\"room\":true}]")";

/// How bright the floor is in the shadow of the table and beside it, against the same without
/// shadows. Means over frames from `first` on.
struct Floor {
  double shadow = 0, lit = 0;
  int frames = 0;  ///< that see both
};
Floor floor_of(const Line& with, const Line& without, size_t first) {
  Floor floor;
  for (size_t n = first; n < with.result.frames.size(); ++n) {
    const GstInverseDepthMeta& meta = with.seen[n].meta;
    double light[2] = {}, free[2] = {};
    for (size_t i = 0; i < size_t{kWidth} * kHeight; ++i) {
      const double z = meta.unit * with.seen[n].depth[i];
      const double p[] = {(double(i % kWidth) - meta.cx) / meta.fx * z,
                          (double(i / kWidth) - meta.cy) / meta.fy * z, z};
      double world[3];
      for (size_t r = 0; r < 3; ++r)
        world[r] = meta.pose[4 * r] * p[0] + meta.pose[4 * r + 1] * p[1] +
                   meta.pose[4 * r + 2] * p[2] + meta.pose[4 * r + 3];
      if (world[1] < 1.21 || std::abs(world[0]) > 1.5 || std::abs(world[2]) > 1.4) continue;
      // Where the way to the lamp is as high as the table's top.
      const double x = std::abs(0.657 * world[0]), across = std::abs(0.657 * (world[2] - 0.1));
      const bool under = x < 0.55 && across<0.3, beside = x> 0.82 || across > 0.62;
      if (!under && !beside) continue;
      light[beside] += light_at(with.result.frames[n], i);
      free[beside] += light_at(without.result.frames[n], i);
    }
    if (!(free[0] > 0.5 && free[1] > 0.5)) continue;
    floor.shadow += light[0] / free[0];
    floor.lit += light[1] / free[1];
    ++floor.frames;
  }
  floor.shadow /= floor.frames;
  floor.lit /= floor.frames;
  return floor;
}

class SceneLamps : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Decomposers, SceneLamps,
                         ::testing::Values("intrinsicdecomp quality=low", "globalintrinsic",
                                           "intrinsicdecompthesis formulation=chapter4"));

// The shadow of the table stays on the same floor while the camera goes around it.
TEST_P(SceneLamps, CastShadowsThatStay) {
  constexpr int kFrames = 24;
  const auto run = [&](const std::string& settings) {
    return Line("speed=4", std::string(kOverTable) + " ambient=0 " + settings, kFrames, {},
                GetParam());
  };
  const Line with = run(""), without = run("shadows=false");
  ASSERT_EQ(with.result.frames.size(), size_t{kFrames}) << with.result.first_error();
  ASSERT_EQ(without.result.frames.size(), size_t{kFrames}) << without.result.first_error();
  EXPECT_TRUE(with.result.warnings.empty()) << with.result.warnings.front();
  const Floor floor = floor_of(with, without, 6);
  printf("  in the shadow %.3f of the light without it, beside it %.3f, in %d frames\n",
         floor.shadow, floor.lit, floor.frames);
  EXPECT_GT(floor.frames, 10);
  EXPECT_LT(floor.shadow, 0.25);
  EXPECT_GT(floor.lit, 0.85);
}

void send(GstElement* element, std::initializer_list<GstEvent*> events) {
  GstPad* pad = gst_element_get_static_pad(element, "src");
  for (GstEvent* event : events) gst_pad_send_event(pad, event);
  gst_object_unref(pad);
}
GstEvent* press(double x, double y) {
  return gst_navigation_event_new_mouse_button_press(1, x, y, GST_NAVIGATION_MODIFIER_NONE);
}
GstEvent* release(double x, double y) {
  return gst_navigation_event_new_mouse_button_release(1, x, y, GST_NAVIGATION_MODIFIER_NONE);
}
GstEvent* move(double x, double y) {
  return gst_navigation_event_new_mouse_move(x, y, GST_NAVIGATION_MODIFIER_NONE);
}

/// The depth of a place from the camera of a frame, and its pixel.
std::array<double, 3> seen_at(const GstInverseDepthMeta& meta, const nlohmann::json& place) {
  std::array<double, 3> p{};
  for (size_t c = 0; c < 3; ++c)
    for (size_t k = 0; k < 3; ++k)
      p[c] += meta.pose[4 * k + c] * (place[k].get<double>() - meta.pose[4 * k + 3]);
  return {meta.fx * p[0] / p[2] + meta.cx, meta.fy * p[1] / p[2] + meta.cy, p[2]};
}

// The mouse puts a lamp before the surface under it, moves it at its depth, and removes it.
TEST(SceneLampsMouse, AddsMovesAndRemoves) {
  std::string added, moved;
  const auto text_of = [](GstElement* element) {
    gchar* text = nullptr;
    g_object_get(element, "lamps", &text, nullptr);
    const std::string result = text ? text : "";
    g_free(text);
    return result;
  };
  const Line line("path=still depth-noise=0", "lamp-mode=add lamp-height=0.3", 24,
                  [&](GstElement* element, int n) {
                    if (n == 8) send(element, {press(80, 60), release(80, 60)});
                    if (n == 8) added = text_of(element);
                    if (n == 12) g_object_set(element, "lamp-mode", 1, nullptr);
                    if (n == 16) send(element, {press(81, 60), move(61, 50), release(61, 50)});
                    if (n == 16) moved = text_of(element);
                    if (n == 18) g_object_set(element, "lamp-mode", 3, nullptr);
                    if (n == 22) send(element, {press(60, 50), release(60, 50)});
                  });
  ASSERT_EQ(line.result.frames.size(), 24U) << line.result.first_error();
  EXPECT_TRUE(line.result.warnings.empty()) << line.result.warnings.front();
  EXPECT_EQ(line.lamps, "");
  const auto lamp_of = [](const std::string& text) {
    const auto json = nlohmann::json::parse(text, nullptr, false);
    return json.is_object() ? json["lamps"][0] : nlohmann::json();
  };
  const nlohmann::json first = lamp_of(added), second = lamp_of(moved);
  ASSERT_TRUE(first.is_object()) << added;
  ASSERT_TRUE(second.is_object()) << moved;
  EXPECT_EQ(first["room"], true);
  const Seen& seen = line.seen.back();
  const double depth = seen.meta.unit * seen.depth[size_t{60} * kWidth + 80];
  const auto at = seen_at(seen.meta, first["position"]),
             to = seen_at(seen.meta, second["position"]);
  EXPECT_NEAR(at[0], 79.5, 0.5);
  EXPECT_NEAR(at[1], 59.5, 0.5);
  EXPECT_NEAR(at[2], depth - 0.3, 0.03);
  EXPECT_NEAR(to[0], 59.5, 0.5);
  EXPECT_NEAR(to[1], 49.5, 0.5);
  EXPECT_NEAR(to[2], at[2], 0.01);
}

// Where the layers carry no scene, a lamp in the room is dark, which is said once.
TEST(SceneLampsMissing, NeedAScene) {
  const auto run = [](const std::string& settings) {
    return Line("path=still", settings, 5, {}, "intrinsicdecomp quality=low scene::remember=false");
  };
  const Line lamp = run(kOverTable), none = run("");
  ASSERT_EQ(lamp.result.frames.size(), 5U) << lamp.result.first_error();
  ASSERT_EQ(lamp.result.warnings.size(), 1U);
  EXPECT_NE(lamp.result.warnings[0].find("remembered scene"), std::string::npos);
  EXPECT_EQ(lamp.result.frames, none.result.frames);
  EXPECT_TRUE(none.result.warnings.empty());
}

}  // namespace
}  // namespace inverse::testing
