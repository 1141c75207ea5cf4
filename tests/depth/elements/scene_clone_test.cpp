// SPDX-License-Identifier: LGPL-2.1-or-later
// Objects that materialclone stands into a remembered scene, by whole lines.
#include <gst/video/navigation.h>

#include <array>
#include <cmath>

#include "gst/inverse/inverse_depth_meta.h"
#include "gst/inverse/inverse_material_meta.h"
#include "tests/elements/element_test.hpp"
#include "tests/elements/lamp.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 160, kHeight = 120;
using Vec3 = std::array<double, 3>;

/// A line with a green object; `when(element, buffer, n)` is called with frame n before it comes to
/// the decomposer.
struct Line {
  LineResult result;
  std::vector<GstInverseDepthMeta> seen;
  Vec3 place{};  ///< room-x, room-y and room-z at the end

  explicit Line(const std::string& source, const std::string& settings, int frames,
                const std::function<void(GstElement*, GstBuffer*, int)>& when = {},
                const std::string& decomposer = "intrinsicdecomp quality=low",
                const std::string& end = "intrinsiccompose") {
    int n = 0;
    const std::string line =
        "rgbdtestsrc is-live=false samples=1 num-buffers=" + std::to_string(frames) + " " + source +
        " ! video/x-raw,width=160,height=120 ! identity name=before ! " + decomposer +
        " ! materialclone name=clone diffuse-color=0xff10ff10 specular=0 " + settings + " ! " +
        end + " ! video/x-raw,format=RGBA ! appsink name=out sync=false";
    result = run_line(line, 240, [&](GstElement* pipeline) {
      GstElement* clone = find_element(pipeline, "clone");
      watch_buffers(find_element(pipeline, "before"), "src", [&, clone](GstBuffer* buffer) {
        if (GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer))
          seen.push_back(*meta);
        if (when) when(clone, buffer, n);
        ++n;
      });
      watch_buffers(find_element(pipeline, "out"), "sink", [&, clone](GstBuffer*) {
        g_object_get(clone, "room-x", &at_[0], "room-y", &at_[1], "room-z", &at_[2], nullptr);
        for (size_t c = 0; c < 3; ++c) place[c] = double{at_[c]};
      });
    });
  }

 private:
  std::array<gfloat, 3> at_{};
};

/// A place from the camera of a frame: pixel, whose center is at a half, and depth.
Vec3 seen_at(const GstInverseDepthMeta& meta, const Vec3& place) {
  Vec3 p{};
  for (size_t c = 0; c < 3; ++c)
    for (size_t k = 0; k < 3; ++k) p[c] += meta.pose[4 * k + c] * (place[k] - meta.pose[4 * k + 3]);
  return {meta.fx * p[0] / p[2] + meta.cx + .5, meta.fy * p[1] / p[2] + meta.cy + .5, p[2]};
}

/// The object's pixels, which are far greener than all of the room.
struct Found {
  double count = 0, x = 0, y = 0;     ///< middle
  double bright_x = 0, bright_y = 0;  ///< of its light
};
Found found_in(const std::vector<uint8_t>& frame) {
  Found found;
  double light = 0;
  for (size_t i = 0; i < size_t{kWidth} * kHeight; ++i) {
    const uint8_t* p = &frame[4 * i];
    if (p[1] < 12 || p[1] < 2.2 * p[0] || p[1] < 2.2 * p[2]) continue;
    const double x = double(i % kWidth) + .5, y = double(i / kWidth) + .5;
    const double value = std::pow(p[1] / 255., 2.2);
    ++found.count;
    found.x += x, found.y += y;
    found.bright_x += value * x, found.bright_y += value * y;
    light += value;
  }
  if (found.count == 0) return found;
  found.x /= found.count, found.y /= found.count;
  found.bright_x /= light, found.bright_y /= light;
  return found;
}

double light_at(const std::vector<uint8_t>& frame, size_t i) {
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) sum += std::pow(frame[4 * i + c] / 255., 2.2) / 3;
  return sum;
}

/// On the table of the virtual room, where it is free.
constexpr const char* kOnTable = "room-x=-0.3 room-y=0.47 room-z=-0.17 room-size=0.2 ";

class SceneClone : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Decomposers, SceneClone,
                         ::testing::Values("intrinsicdecomp quality=low", "globalintrinsic",
                                           "intrinsicdecompthesis formulation=chapter4"));

TEST_P(SceneClone, StaysAtItsPlaceAndShadesIt) {
  constexpr int kFrames = 16;
  const auto run = [&](const std::string& settings) {
    return Line("speed=6", "room-x=0 room-y=0.2 room-z=0.1 source=properties " + settings, kFrames,
                {}, GetParam());
  };
  const Line with = run("room-size=0.2"), without = run("room-size=0");
  ASSERT_EQ(with.result.frames.size(), size_t{kFrames}) << with.result.first_error();
  ASSERT_EQ(without.result.frames.size(), size_t{kFrames}) << without.result.first_error();
  EXPECT_TRUE(with.result.warnings.empty()) << with.result.warnings.front();
  double farthest = 0;
  int frames = 0;
  for (size_t n = 0; n < kFrames; ++n) {
    // It hovers above the table.
    const Vec3 at = seen_at(with.seen[n], {0, .1, .1});
    const double radius = with.seen[n].fx * .1 / at[2];
    if (at[0] < radius + 2 || at[0] > kWidth - radius - 2 || at[1] < radius + 2 ||
        at[1] > kHeight - radius - 2)
      continue;
    const Found found = found_in(with.result.frames[n]);
    EXPECT_NEAR(found.count, 3.14159 * radius * radius, .2 * 3.14159 * radius * radius) << n;
    farthest = std::max(farthest, std::hypot(found.x - at[0], found.y - at[1]));
    ++frames;
  }
  printf("  at most %.2f pixels from its place in %d frames\n", farthest, frames);
  EXPECT_GT(frames, 8);
  EXPECT_LT(farthest, 1.5);
}

TEST(SceneCloneLight, DarkensWhatItStandsOn) {
  const auto run = [](const std::string& settings) {
    return Line("path=still depth-noise=0", std::string(kOnTable) + "source=properties " + settings,
                8);
  };
  const Line with = run(""), faint = run("tuning=shadow=0.2"), none = run("tuning=shadow=0"),
             without = run("room-size=0");
  for (const Line* line : {&with, &faint, &none, &without})
    ASSERT_EQ(line->result.frames.size(), 8U) << line->result.first_error();
  // Before its foot, and far away from it.
  const Vec3 foot = seen_at(with.seen.back(), {-.3, .47, -.25});
  const auto ratio = [&](const Line& line, double x, double y) {
    double light = 0, bare = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const size_t i = size_t(y + dy) * kWidth + size_t(x + dx);
        light += light_at(line.result.frames.back(), i);
        bare += light_at(without.result.frames.back(), i);
      }
    return light / bare;
  };
  printf("  of the light %.2f, %.2f and %.2f stay at its foot\n", ratio(with, foot[0], foot[1]),
         ratio(faint, foot[0], foot[1]), ratio(none, foot[0], foot[1]));
  EXPECT_LT(ratio(with, foot[0], foot[1]), .8);
  EXPECT_GT(ratio(faint, foot[0], foot[1]), ratio(with, foot[0], foot[1]) + .1);
  EXPECT_NEAR(ratio(none, foot[0], foot[1]), 1, .02);
  for (const auto& [x, y] : {std::pair{15, 15}, {20, 100}, {145, 20}})
    EXPECT_NEAR(ratio(with, x, y), 1, .02);
}

TEST(SceneCloneLight, IsHiddenByWhatIsNearer) {
  // On the floor behind the table, and at its height before it.
  const Line hidden("path=still depth-noise=0",
                    "source=properties room-x=0 room-y=1.2 room-z=0.9 room-size=0.2", 8),
      open("path=still depth-noise=0",
           "source=properties room-x=0 room-y=0.3 room-z=-0.6 room-size=0.1", 8);
  ASSERT_EQ(hidden.result.frames.size(), 8U) << hidden.result.first_error();
  ASSERT_EQ(open.result.frames.size(), 8U) << open.result.first_error();
  EXPECT_EQ(found_in(hidden.result.frames.back()).count, 0);
  EXPECT_GT(found_in(open.result.frames.back()).count, 80);
}

/// As limematerial: light from the right alone.
void add_light(GstBuffer* buffer, GBytes* map) {
  const GstMetaInfo* info = gst_meta_get_info("GstMaterialMeta");
  ASSERT_NE(info, nullptr);
  auto* meta = reinterpret_cast<GstMaterialMeta*>(gst_buffer_add_meta(buffer, info, nullptr));
  meta->environment_width = 64;
  meta->environment_height = 32;
  meta->environment = g_bytes_ref(map);
}

// The light that was found in the first frame stays on its side of the room while the camera goes
// around.
TEST(SceneCloneLight, KeepsTheLightOfTheStreamInTheRoom) {
  const Environment light = lamp(2, 20, 20, 20);
  GBytes* map = g_bytes_new(light.rgb().data(), light.rgb().size() * sizeof(float));
  constexpr int kFrames = 40;
  const Line line("speed=8", "room-x=0 room-y=0.2 room-z=0.1 room-size=0.2", kFrames,
                  [&](GstElement*, GstBuffer* buffer, int) { add_light(buffer, map); });
  g_bytes_unref(map);
  ASSERT_EQ(line.result.frames.size(), size_t{kFrames}) << line.result.first_error();
  // In the world: to the right of the first camera.
  const GstInverseDepthMeta& first = line.seen.front();
  const Vec3 to{first.pose[0], first.pose[4], first.pose[8]};
  int frames = 0, left = 0;
  for (size_t n = 0; n < kFrames; ++n) {
    const GstInverseDepthMeta& meta = line.seen[n];
    double side = 0;  // from the right, -1…1
    for (size_t k = 0; k < 3; ++k) side += meta.pose[4 * k] * to[k];
    const Vec3 at = seen_at(meta, {0, .1, .1});
    const Found found = found_in(line.result.frames[n]);
    if (std::abs(side) < .6 || found.count < 60 || at[0] < 30 || at[0] > kWidth - 30) continue;
    ++frames;
    left += side < 0;
    EXPECT_GT((found.bright_x - at[0]) * side, 1) << n;
  }
  EXPECT_GT(frames, 10);
  EXPECT_GT(left, 3) << "never seen from behind";
}

// A scene that is forgotten has its axes from the next frame on; the light stays where it was.
TEST(SceneCloneLight, KeepsTheLightWhenTheSceneIsForgotten) {
  const Environment light = lamp(2, 20, 20, 20);
  GBytes* map = g_bytes_new(light.rgb().data(), light.rgb().size() * sizeof(float));
  constexpr int kFrames = 44, kForgotten = 38;
  const std::string place = "room-x=0 room-y=0.1 room-z=0.6 room-size=0.2";
  const Line line(
      "speed=8", place, kFrames,
      [&](GstElement* clone, GstBuffer* buffer, int n) {
        gst_buffer_get_inverse_depth_meta(buffer)->posed = FALSE;  // else axes are those before
        if (n == 0) add_light(buffer, map);
        GstObject* pipeline = gst_object_get_parent(GST_OBJECT(clone));
        if (n == kForgotten)
          g_signal_emit_by_name(find_element(GST_ELEMENT(pipeline), "decomposer"), "forget-scene");
        gst_object_unref(pipeline);
      },
      "intrinsicdecomp name=decomposer quality=low");
  g_bytes_unref(map);
  ASSERT_EQ(line.result.frames.size(), size_t{kFrames}) << line.result.first_error();
  const GstInverseDepthMeta& first = line.seen.front();
  int frames = 0;
  for (size_t n = kForgotten; n < kForgotten + 6; ++n) {
    double side = 0;
    for (size_t k = 0; k < 3; ++k) side += line.seen[n].pose[4 * k] * first.pose[4 * k];
    const Found found = found_in(line.result.frames[n]);
    if (std::abs(side) < .5 || found.count < 60) continue;
    ++frames;
    EXPECT_GT((found.bright_x - found.x) * side, 1) << n;
  }
  EXPECT_GT(frames, 3);
}

void send(GstElement* element, std::initializer_list<GstEvent*> events) {
  GstPad* pad = gst_element_get_static_pad(element, "src");
  for (GstEvent* event : events) gst_pad_send_event(pad, event);
  gst_object_unref(pad);
}

TEST(SceneCloneMouse, DragsOverTheSurface) {
  const Line line(
      "path=still depth-noise=0", "source=properties drag=true room-size=0.1", 16,
      [](GstElement* element, GstBuffer*, int n) {
        if (n != 8) return;
        send(element,
             {gst_navigation_event_new_mouse_button_press(1, 100, 70, GST_NAVIGATION_MODIFIER_NONE),
              gst_navigation_event_new_mouse_move(80, 60, GST_NAVIGATION_MODIFIER_NONE),
              gst_navigation_event_new_mouse_button_release(1, 80, 60,
                                                            GST_NAVIGATION_MODIFIER_NONE)});
      });
  ASSERT_EQ(line.result.frames.size(), 16U) << line.result.first_error();
  const Vec3 at = seen_at(line.seen.back(), line.place);
  EXPECT_NEAR(at[0], 80.5, .6);
  EXPECT_NEAR(at[1], 60.5, .6);
  EXPECT_NEAR(line.place[1], .47, .05) << "on the table or the book on it";
}

TEST(SceneCloneMissing, NeedsAScene) {
  const auto run = [](const std::string& settings) {
    return Line("path=still", "source=properties " + settings, 5, {},
                "intrinsicdecomp quality=low scene::remember=false");
  };
  const Line object = run(kOnTable), none = run("room-size=0");
  ASSERT_EQ(object.result.frames.size(), 5U) << object.result.first_error();
  ASSERT_EQ(object.result.warnings.size(), 1U);
  EXPECT_NE(object.result.warnings[0].find("remembered scene"), std::string::npos);
  EXPECT_EQ(object.result.frames, none.result.frames);
}

// Behind a decomposer it still draws over pictures where pictures are wanted.
TEST(SceneCloneMissing, DrawsOverPicturesAsBefore) {
  const Line line("path=still", "source=properties size=0.5", 3, {},
                  "intrinsicdecomp quality=low show=input", "identity");
  ASSERT_EQ(line.result.frames.size(), 3U) << line.result.first_error();
  EXPECT_TRUE(line.result.warnings.empty());
  const Found found = found_in(line.result.frames.back());
  EXPECT_NEAR(found.x, 80, 2);
  EXPECT_GT(found.count, 1500);
}

}  // namespace
}  // namespace inverse::testing
