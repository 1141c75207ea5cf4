// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsicselect, and what intrinsicrecolor makes of its mask and of clicks.
#include <gst/video/navigation.h>

#include <cmath>
#include <fstream>

#include "tests/elements/draw.hpp"
#include "tests/elements/edit/edit_fixture.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

constexpr int kWidth = 160, kHeight = 120, kRadius = 25;
const std::string kCaps = VideoHarness::caps("RGBA", kWidth, kHeight);
const std::string kLight = "intrinsicdecomp adaptive=false light-color-slope=0 ! ";

/// A red disc at (x, y), one of the same red at the right, and a wall.
std::vector<uint8_t> discs(int x, int y, unsigned seed = 1) {
  std::mt19937 random(seed);
  return draw(kWidth, kHeight, [&](int u, int v, int c) {
    constexpr int kWall[] = {90, 130, 110}, kRed[] = {190, 50, 40};
    const bool red = std::hypot(u - x, v - y) < kRadius || std::hypot(u - 140, v - 20) < 12;
    return (red ? kRed : kWall)[c] + static_cast<int>(random() % 5) - 2;
  });
}

/// Share of the pixels of a mask that is drawn (R of RGBA) that are on the wrong side.
double wrong_share(const std::vector<uint8_t>& mask, int x, int y) {
  int wrong = 0;
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u)
      wrong += (pixel_at(mask, u, v, kWidth)[0] > 127) != (std::hypot(u - x, v - y) < kRadius);
  return static_cast<double>(wrong) / (kWidth * kHeight);
}

std::string stroke_at(int x, int y, const char* kind = "add") {
  return std::string("{\"kind\":\"") + kind + "\",\"points\":[[" + std::to_string(x) + "," +
         std::to_string(y) + "]]}";
}

std::string chain(const std::string& select, const std::string& show = "mask") {
  return kLight + "intrinsicselect " + select + " ! intrinsiccompose show=" + show;
}

/// Writes a gray PNG, whose width is a multiple of 4.
std::string draw_png(const std::string& path, int width, int height,
                     const std::vector<uint8_t>& gray) {
  VideoHarness encoder("pngenc", VideoHarness::caps("GRAY8", width, height));
  const auto png = encoder.process(gray);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  return path;
}

void press_and_release(VideoHarness& harness, double x, double y) {
  harness.send_upstream(
      gst_navigation_event_new_mouse_button_press(1, x, y, GST_NAVIGATION_MODIFIER_NONE));
  harness.send_upstream(
      gst_navigation_event_new_mouse_button_release(1, x, y, GST_NAVIGATION_MODIFIER_NONE));
}

}  // namespace

TEST(Select, AClickSelectsAnObjectAndFollowsIt) {
  VideoHarness harness(chain("strokes::mode=add"), kCaps, kCaps);
  EXPECT_GT(wrong_share(harness.process(discs(50, 60)), 50, 60), .05) << "nothing is selected yet";
  press_and_release(harness, 50, 60);
  EXPECT_LT(wrong_share(harness.process(discs(50, 60)), 50, 60), .01);
  for (int n = 1; n < 20; ++n)
    EXPECT_LT(wrong_share(harness.process(discs(50 + 2 * n, 60 + n)), 50 + 2 * n, 60 + n), .01)
        << n;
  GstElement* select = harness.find("intrinsicselect");
  EXPECT_NE(property<std::string>(select, "strokes::list"), "");
  EXPECT_NEAR(stat<double>(select, "object-x"), 88, 3);
  EXPECT_NEAR(stat<double>(select, "object-y"), 79, 3);
  EXPECT_NEAR(stat<double>(select, "object-right") - stat<double>(select, "object-left"),
              2 * kRadius, 4);
  EXPECT_NEAR(stat<double>(select, "object-share"), 3.1416 * kRadius * kRadius / (kWidth * kHeight),
              .02);
  EXPECT_TRUE(harness.warnings().empty());
}

TEST(Select, StrokesAddAndSubtract) {
  VideoHarness harness(chain(""), kCaps, kCaps);
  GstElement* select = harness.find("intrinsicselect");
  gboolean done = FALSE;
  g_signal_emit_by_name(select, "add-stroke", stroke_at(50, 60).c_str(), &done);
  EXPECT_TRUE(done);
  EXPECT_LT(wrong_share(harness.process(discs(50, 60)), 50, 60), .01);
  // The other disc, too.
  g_signal_emit_by_name(select, "add-stroke", stroke_at(140, 20).c_str(), &done);
  const auto both = harness.process(discs(50, 60));
  EXPECT_GT(pixel_at(both, 140, 20, kWidth)[0], 200);
  EXPECT_GT(pixel_at(both, 50, 60, kWidth)[0], 200);
  // And not.
  g_signal_emit_by_name(select, "undo-stroke", &done);
  EXPECT_TRUE(done);
  EXPECT_LT(wrong_share(harness.process(discs(50, 60)), 50, 60), .01);
  g_signal_emit_by_name(select, "clear-strokes", &done);
  EXPECT_LT(pixel_at(harness.process(discs(50, 60)), 50, 60, kWidth)[0], 5);
  // A line around it.
  gst_child_proxy_set(
      GST_CHILD_PROXY(select), "strokes::list",
      "[{\"kind\":\"add\",\"closed\":true,\"radius\":1,\"points\":[[30,40],[70,40],[70,80],[30,"
      "80]]}]",
      nullptr);
  const auto square = harness.process(discs(50, 60));
  int wrong = 0;
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u)
      wrong +=
          (pixel_at(square, u, v, kWidth)[0] > 127) != (u >= 30 && u < 70 && v >= 40 && v < 80);
  EXPECT_LT(wrong, 400) << "2.5 pixels along the line";
}

TEST(Select, ALassoEndsAtItsLineOnOnePaint) {
  VideoHarness harness(chain("strokes::list=[{\"kind\":\"add\",\"closed\":true,\"points\":"
                             "[[40,30],[120,30],[120,90],[40,90]]}]"),
                       kCaps, kCaps);
  for (unsigned n = 0; n < 5; ++n) {
    const auto mask = harness.process(discs(-100, 0, n));
    int wrong = 0;
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u)
        wrong +=
            (pixel_at(mask, u, v, kWidth)[0] > 127) != (u >= 40 && u < 120 && v >= 30 && v < 90);
    EXPECT_LT(wrong, 300) << n;
  }
}

TEST(Select, InvertsAndCombines) {
  const std::string first = "strokes::list=[" + stroke_at(50, 60) + "]";
  VideoHarness inverted(chain(first + " invert=true"), kCaps, kCaps);
  const auto rest = inverted.process(discs(50, 60));
  EXPECT_LT(pixel_at(rest, 50, 60, kWidth)[0], 5);
  EXPECT_GT(pixel_at(rest, 5, 5, kWidth)[0], 250);
  for (const auto& [combine, left, right] : {std::tuple{"replace", false, true},
                                             {"add", true, true},
                                             {"subtract", true, false},
                                             {"intersect", false, false}}) {
    VideoHarness harness(kLight + "intrinsicselect " + first +
                             " ! intrinsicselect strokes::list=[" + stroke_at(140, 20) +
                             "] combine=" + combine + " ! intrinsiccompose show=mask",
                         kCaps, kCaps);
    const auto mask = harness.process(discs(50, 60));
    EXPECT_EQ(pixel_at(mask, 50, 60, kWidth)[0] > 127, left) << combine;
    EXPECT_EQ(pixel_at(mask, 140, 20, kWidth)[0] > 127, right) << combine;
  }
}

TEST(Select, ByKeyClusterAndBaseColor) {
  VideoHarness key(chain("by=key key=0xffbe3228"), kCaps, kCaps);
  const auto mask = key.process(discs(50, 60));
  EXPECT_GT(pixel_at(mask, 50, 60, kWidth)[0], 200);
  EXPECT_GT(pixel_at(mask, 140, 20, kWidth)[0], 200);
  EXPECT_LT(pixel_at(mask, 80, 110, kWidth)[0], 5);
  VideoHarness clusters(chain("by=cluster clusters=4"), kCaps, kCaps);
  bool disc = false, wall = false;  // alone; one of several merged clusters stands for all of them
  for (int cluster = 0; cluster < 4; ++cluster) {
    g_object_set(clusters.find("intrinsicselect"), "cluster", cluster, nullptr);
    const auto selected = clusters.process(discs(50, 60));
    const bool in_disc = pixel_at(selected, 50, 60, kWidth)[0] > 127,
               in_wall = pixel_at(selected, 80, 110, kWidth)[0] > 127;
    EXPECT_FALSE(in_disc && in_wall) << cluster;
    disc |= in_disc;
    wall |= in_wall;
  }
  EXPECT_TRUE(disc && wall);
  VideoHarness base(chain("by=base-color"), kCaps, kCaps);
  base.process(discs(50, 60));
  EXPECT_EQ(base.warnings().size(), 1U);
}

TEST(Select, ByAPictureOfAnySize) {
  const TemporaryFolder folder;
  const std::string path = draw_png(folder / "mask.png", 4, 1, {255, 255, 0, 0});
  VideoHarness harness(chain("by=picture soft-edges=false location=" + path), kCaps, kCaps);
  const auto mask = harness.process(discs(50, 60));
  EXPECT_GT(pixel_at(mask, 10, 60, kWidth)[0], 250);
  EXPECT_LT(pixel_at(mask, 150, 60, kWidth)[0], 5);
  // Another while frames go on, larger than the frame.
  std::vector<uint8_t> large(1000 * 600, 0);
  std::fill_n(large.begin(), large.size() / 2, 255);
  g_object_set(harness.find("intrinsicselect"), "location",
               draw_png(folder / "large.png", 1000, 600, large).c_str(), nullptr);
  std::vector<uint8_t> next;
  for (int n = 0; n < 200; ++n) {
    next = harness.process(discs(50, 60));
    if (pixel_at(next, 150, 20, kWidth)[0] > 250) break;
    g_usleep(10000);
  }
  EXPECT_GT(pixel_at(next, 150, 20, kWidth)[0], 250);
  EXPECT_LT(pixel_at(next, 10, 100, kWidth)[0], 5);
  EXPECT_TRUE(harness.warnings().empty());
}

TEST(Select, AMissingPictureIsOneError) {
  const auto result = run_line("videotestsrc num-buffers=2 ! " + kLight +
                               "intrinsicselect by=picture location=/nowhere/mask.png ! "
                               "intrinsiccompose ! fakesink");
  ASSERT_EQ(result.errors.size(), 1U);
  EXPECT_NE(result.first_error().find("/nowhere/mask.png"), std::string::npos)
      << result.first_error();
}

TEST(Select, WrongStrokesAreAWarning) {
  VideoHarness harness(chain("strokes::list=[" + stroke_at(50, 60) + "]"), kCaps, kCaps);
  GstElement* select = harness.find("intrinsicselect");
  for (const char* wrong :
       {"[", "{}", "[{\"kind\":\"shading\",\"points\":[[1,2]]}]", "[{\"points\":[[1,2]]}]",
        "[{\"kind\":\"add\",\"points\":[]}]", "[{\"kind\":\"add\",\"points\":[[1]]}]",
        "[{\"kind\":\"add\",\"points\":[[1,2]],\"radius\":-1}]"}) {
    gst_child_proxy_set(GST_CHILD_PROXY(select), "strokes::list", wrong, nullptr);
    EXPECT_EQ(harness.warnings().size(), 1U) << wrong;
    EXPECT_LT(wrong_share(harness.process(discs(50, 60)), 50, 60), .01) << "the ones before stay";
  }
  gboolean done = TRUE;
  g_signal_emit_by_name(select, "add-stroke", "no", &done);
  EXPECT_FALSE(done);
  // Far away, of zero length, and many.
  std::string many;
  for (int n = 0; n < 64; ++n) many.append(n ? "," : "").append(stroke_at(-1000000, 99 * n));
  gst_child_proxy_set(GST_CHILD_PROXY(select), "strokes::list", ("[" + many + "]").c_str(),
                      nullptr);
  EXPECT_LT(pixel_at(harness.process(discs(50, 60)), 50, 60, kWidth)[0], 5);
  gst_child_proxy_set(GST_CHILD_PROXY(select), "strokes::list",
                      ("[" + many + "," + stroke_at(1, 1) + "]").c_str(), nullptr);
  const auto warnings = harness.warnings();
  ASSERT_EQ(warnings.size(), 3U);  // and that of add-stroke
  expect_contains(warnings[1], "strokes 1, 2, 3, ");
  expect_contains(warnings[2], "strokes::list: there are 65 strokes; at most 64");
}

TEST(Select, StrokesWithoutEffectAreOneWarningEach) {
  VideoHarness harness(chain(""), kCaps, kCaps);
  GstElement* select = harness.find("intrinsicselect");
  const auto warnings_of = [&](const std::string& strokes) {
    gst_child_proxy_set(GST_CHILD_PROXY(select), "strokes::list", ("[" + strokes + "]").c_str(),
                        nullptr);
    for (int n = 0; n < 3; ++n) harness.process(discs(50, 60));
    harness.flush();
    harness.process(discs(50, 60));
    return harness.warnings();
  };
  const std::string good = stroke_at(50, 60);
  expect_one(warnings_of(good + "," + stroke_at(5000, 5000)),
             "stroke 2: ", "outside of the frame of 160x120 pixels");
  expect_one(warnings_of(stroke_at(20, 20) + "," + good + "," + stroke_at(50, 60, "subtract")),
             "stroke 2: ", "cover all of it");
  expect_one(warnings_of(stroke_at(50, 60, "subtract")), "stroke 1: ", "kind add");
  EXPECT_TRUE(warnings_of(good + "," + stroke_at(60, 60, "subtract")).empty());
  // One that is appended has its number, and is drawn where the object is then.
  EXPECT_TRUE(warnings_of(good).empty());
  gst_child_proxy_set(GST_CHILD_PROXY(select), "strokes::list",
                      ("[" + good + "," + stroke_at(50, 60, "subtract") + "]").c_str(), nullptr);
  harness.process(discs(90, 60));
  EXPECT_TRUE(harness.warnings().empty());
  expect_one(warnings_of(good + "," + stroke_at(50, 60, "subtract") + "," + stroke_at(-99, 60)),
             "stroke 3: ");
}

TEST(Select, TheMouseDrawsNoMoreThanThereIsRoomFor) {
  VideoHarness harness(chain("strokes::mode=add"), kCaps, kCaps);
  GstElement* select = harness.find("intrinsicselect");
  const auto strokes = [&] { return property<std::string>(select, "strokes::list"); };
  harness.process(discs(50, 60));
  std::string full;
  for (int n = 0; n < 65; ++n) {
    press_and_release(harness, 40 + n % 8, 50 + n / 8.);
    if (n == 63) full = strokes();
  }
  EXPECT_NE(full, "");
  EXPECT_EQ(strokes(), full) << "none is dropped";
  harness.process(discs(50, 60));
  expect_one(harness.warnings(), "there are 64 strokes already; remove one");
  gboolean done = FALSE;
  g_signal_emit_by_name(select, "add-stroke", stroke_at(1, 1).c_str(), &done);
  EXPECT_FALSE(done);
  expect_one(harness.warnings(), "remove one");
  g_signal_emit_by_name(select, "remove-stroke", 65U, &done);
  EXPECT_FALSE(done);
  expect_one(harness.warnings(), "there is no stroke 65; there are 64");
  g_signal_emit_by_name(select, "remove-stroke", 1U, &done);
  EXPECT_TRUE(done);
  EXPECT_EQ(strokes().find("[40.0,50.0]"), std::string::npos);
  EXPECT_NE(strokes().find("[41.0,50.1]"), std::string::npos);
  g_signal_emit_by_name(select, "undo-stroke", &done);
  EXPECT_EQ(strokes(), full);
  // A long one.
  g_signal_emit_by_name(select, "clear-strokes", &done);
  gst_child_proxy_set(GST_CHILD_PROXY(select), "strokes::radius", 1.F, nullptr);
  const auto move = [&](GstEvent* event) { harness.send_upstream(event); };
  move(gst_navigation_event_new_mouse_button_press(1, 0, 0, GST_NAVIGATION_MODIFIER_NONE));
  for (int n = 0; n < 5000; ++n)
    move(gst_navigation_event_new_mouse_move(n % 160, n / 160, GST_NAVIGATION_MODIFIER_NONE));
  move(gst_navigation_event_new_mouse_button_release(1, 80, 90, GST_NAVIGATION_MODIFIER_NONE));
  EXPECT_TRUE(strokes().ends_with("[80.0,90.0]]}]")) << "its end is where the button went up";
  harness.process(discs(50, 60));
  expect_one(harness.warnings(), "4096 points");
}

/// Of a frame of a scene in which the disc is at (60 + 8 n, 60) from frame 2 on, and before at
/// (50, 60).
int disc_at(int n) { return n < 2 ? 50 : 60 + 8 * n; }

/// Frames by their numbers, as a pipeline that is sought gives them.
class Sought : public ::testing::Test {
 protected:
  std::vector<uint8_t> seek(int n) {
    harness_.flush();
    return show(n);
  }
  std::vector<uint8_t> show(int n) {
    harness_.set_next_time(GstClockTime(n) * 40 * GST_MSECOND);
    return harness_.process(discs(disc_at(n), 60, unsigned(n)));
  }
  void set(const std::string& strokes) {
    gst_child_proxy_set(GST_CHILD_PROXY(harness_.find("intrinsicselect")), "strokes::list",
                        ("[" + strokes + "]").c_str(), nullptr);
  }
  static double wrong(const std::vector<uint8_t>& mask, int n) {
    return wrong_share(mask, disc_at(n), 60);
  }

  VideoHarness harness_{chain("strokes::list=[]"), kCaps, kCaps};
};

TEST_F(Sought, ASelectionStaysItsObject) {
  set(stroke_at(50, 60));
  EXPECT_LT(wrong(show(0), 0), .01);
  for (int n = 1; n < 4; ++n) show(n);
  // The stroke is on the wall there.
  EXPECT_LT(wrong(seek(8), 8), .01);
  EXPECT_LT(wrong(show(9), 9), .01);
  EXPECT_LT(wrong(seek(9), 9), .01) << "the same frame again";
  EXPECT_LT(wrong(seek(3), 3), .01);
  EXPECT_LT(wrong(seek(0), 0), .01) << "where it was drawn";
}

TEST_F(Sought, UndoGoesBackToWhatWasSelected) {
  const std::string disc = stroke_at(50, 60);
  set(disc);
  for (int n = 0; n < 5; ++n) show(n);
  // On a picture that stands: the other disc is added, and that is undone, done again and undone.
  const std::string both = disc + "," + stroke_at(140, 20);
  for (int i = 0; i < 2; ++i) {
    set(both);
    EXPECT_GT(wrong(seek(4), 4), .015);
    set(disc);
    EXPECT_LT(wrong(seek(4), 4), .01);
  }
  // The same while it plays.
  set(both);
  EXPECT_GT(wrong(show(5), 5), .015);
  show(6);
  set(disc);
  EXPECT_LT(wrong(show(7), 7), .01);
  EXPECT_LT(wrong(show(8), 8), .01);
}

TEST_F(Sought, AnotherVideoSelectsAnew) {
  set(stroke_at(50, 60));
  for (int n = 0; n < 4; ++n) show(n);
  gst_harness_push_event(harness_.harness(), gst_event_new_stream_start("another"));
  harness_.flush();
  EXPECT_LT(wrong(show(1), 1), .01);
}

TEST(Select, TakesAnySize) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {349, 2}, {15, 200}, {700, 33}}) {
    const std::string caps = VideoHarness::caps("RGBA", width, height);
    VideoHarness harness(kLight + "intrinsicselect strokes::list=[" +
                             stroke_at(width / 2, height / 2) +
                             "] ! intrinsicrecolor ! intrinsiccompose",
                         caps, caps);
    for (unsigned n = 0; n < 3; ++n) EXPECT_FALSE(harness.process(random_frame(caps, n)).empty());
    EXPECT_TRUE(harness.errors().empty());
  }
}

TEST(Recolor, TheMaskOfASelectionChangesTheObjectOnly) {
  const std::string select = "intrinsicselect strokes::list=[" + stroke_at(50, 60) + "] ! ";
  VideoHarness harness(kLight + select + "intrinsicrecolor target=0xff2040c0 ! intrinsiccompose",
                       kCaps, kCaps);
  const auto frame = discs(50, 60), edited = harness.process(frame);
  EXPECT_GT(pixel_at(edited, 50, 60, kWidth)[2], pixel_at(edited, 50, 60, kWidth)[0] + 50);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(pixel_at(edited, 140, 20, kWidth)[c], pixel_at(frame, 140, 20, kWidth)[c], 1);
    EXPECT_NEAR(pixel_at(edited, 10, 100, kWidth)[c], pixel_at(frame, 10, 100, kWidth)[c], 1);
  }
  // Its own colors, turned.
  g_object_set(harness.find("intrinsicrecolor"), "target", 0, "hue-shift", 120.0, nullptr);
  const auto turned = harness.process(frame);
  EXPECT_GT(pixel_at(turned, 50, 60, kWidth)[1], pixel_at(turned, 50, 60, kWidth)[0] + 50);
  // Its brightness stays.
  g_object_set(harness.find("intrinsicrecolor"), "target", 0xffc0c0c0U, "hue-shift", 0.0,
               "brightness", 1.0, nullptr);
  const auto gray = harness.process(frame);
  EXPECT_NEAR(pixel_at(gray, 50, 60, kWidth)[0], pixel_at(gray, 50, 60, kWidth)[2], 6);
  EXPECT_LT(pixel_at(gray, 50, 60, kWidth)[0], 140);
}

TEST(Recolor, WithoutASelectionItSaysSoAndChangesNothing) {
  VideoHarness harness(kLight + "intrinsicrecolor ! intrinsiccompose", kCaps, kCaps);
  const auto frame = discs(50, 60);
  EXPECT_LE(largest_difference(harness.process(frame), frame), 1);
  const auto warnings = harness.warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("intrinsicselect"), std::string::npos) << warnings[0];
}

TEST(Recolor, AClickPicksAColor) {
  VideoHarness harness(kLight + "intrinsicrecolor pick=key ! intrinsiccompose", kCaps, kCaps);
  GstElement* recolor = harness.find("intrinsicrecolor");
  harness.process(discs(50, 60));
  press_and_release(harness, 50, 60);
  harness.process(discs(50, 60), 4);
  const auto key = property<guint>(recolor, "key");
  EXPECT_GT(key >> 16 & 255, (key & 255) + 60) << std::hex << key;
  g_object_set(recolor, "pick", 2, nullptr);
  press_and_release(harness, 1e9, NAN);
  press_and_release(harness, 5, 5);
  const auto edited = harness.process(discs(50, 60), 5);
  const auto target = property<guint>(recolor, "target");
  EXPECT_GT(target >> 8 & 255, target >> 16 & 255) << std::hex << target;
  // The disc has the wall's color, in its own light.
  const uint8_t *disc = pixel_at(edited, 50, 60, kWidth), *wall = pixel_at(edited, 5, 5, kWidth);
  for (int c = 1; c < 3; ++c) EXPECT_NEAR(disc[c] * 1. / disc[0], wall[c] * 1. / wall[0], .12) << c;
}

}  // namespace inverse::testing
