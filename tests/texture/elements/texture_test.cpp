// SPDX-License-Identifier: LGPL-2.1-or-later
// intrinsictexture: where the picture hangs, what it needs, what it refuses.
#include <gst/video/navigation.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "gst/texture/corners_text.hpp"
#include "tests/elements/draw.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/texture/wall_scene.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

using namespace std::string_literals;

constexpr int kWidth = 320, kHeight = 240;
const std::string kCaps = VideoHarness::caps("RGB", kWidth, kHeight);
const std::string kBox = "corners=\"100,60 220,60 220,180 100,180\" ";

/// Pictures of one pixel.
class Pictures {
  TemporaryFolder folder_;

 public:
  std::string red = write_picture(folder_ / "red.png", {1, 1, CV_8UC3, {255, 0, 0}});
  std::string green = write_picture(folder_ / "green.png", {1, 1, CV_8UC3, {0, 255, 0}});
  std::string text = folder_.write("text.png", "this is a text");
  const TemporaryFolder& folder() const { return folder_; }
};

const WallScene& wall() {
  static const WallScene scene({kWidth, kHeight});
  return scene;
}
std::vector<uint8_t> bytes_of(const cv::Mat& picture) {
  return {picture.data, picture.data + picture.total() * picture.elemSize()};
}
std::vector<uint8_t> wall_frame(int n) { return bytes_of(wall().at(n).picture); }
/// Something with no feature at all, in gray.
std::vector<uint8_t> flat() { return flat_frame(kCaps, 120); }

std::string chain(const std::string& properties) {
  return "intrinsicdecomp light-color-slope=0 ! intrinsictexture name=t " + properties +
         " ! intrinsiccompose";
}
/// How much more of one channel than of the others there is at a place, in codes.
int excess(const std::vector<uint8_t>& frame, int x, int y, int channel, int width = kWidth) {
  const uint8_t* p =
      &frame[3 * (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x))];
  int others = 0;
  for (int c = 0; c < 3; ++c)
    if (c != channel) update_max(others, int{p[c]});
  return p[channel] - others;
}
bool red_at(const std::vector<uint8_t>& frame, int x, int y) { return excess(frame, x, y, 0) > 40; }
bool green_at(const std::vector<uint8_t>& frame, int x, int y) {
  return excess(frame, x, y, 1) > 40;
}

struct Middle {
  int x, y;
};
Middle middle_of(const Corners& corners) {
  double x = 0, y = 0;
  for (const Point& p : corners) x += p[0] / 4, y += p[1] / 4;
  return {static_cast<int>(x), static_cast<int>(y)};
}

class Texture : public ::testing::Test {
 protected:
  Pictures pictures;
};

}  // namespace

TEST_F(Texture, HangsWhereItIsToldAndLightStays) {
  VideoHarness harness(chain("track=false location=" + pictures.red + " " + kBox), kCaps, kCaps);
  // Light falls off to the right.
  std::vector<uint8_t> frame = flat();
  for (size_t i = 0; i < frame.size(); ++i)
    frame[i] = static_cast<uint8_t>(200 - static_cast<int>(i / 3) % kWidth / 2);
  const auto out = harness.process(frame, 3);
  EXPECT_TRUE(red_at(out, 160, 120));
  for (const auto& [x, y] : {std::pair{95, 120}, {225, 120}, {160, 55}, {160, 185}}) {
    EXPECT_FALSE(red_at(out, x, y)) << x << "," << y;
    EXPECT_NEAR(out[3 * static_cast<size_t>(y * kWidth + x)],
                frame[3 * static_cast<size_t>(y * kWidth + x)], 1);
  }
  EXPECT_GT(excess(out, 110, 120, 0), excess(out, 210, 120, 0) + 15) << "the light is gone";
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_F(Texture, CostsNothingIfThereIsNothingToShow) {
  for (const std::string& neutral :
       {""s, kBox, "location=" + pictures.red, "opacity=0 location=" + pictures.red}) {
    VideoHarness harness(chain(neutral), kCaps, kCaps);
    for (int n = 0; n < 3; ++n)
      EXPECT_LE(largest_difference(harness.process(wall_frame(n)), wall_frame(n)), 1) << neutral;
    EXPECT_EQ(stat<guint>(harness.find("intrinsictexture"), "dispatches"), 0U) << neutral;
    if (neutral == kBox)
      expect_one(harness.warnings(), "there is no picture to hang; set location");
    else
      EXPECT_TRUE(harness.warnings().empty());
  }
}

TEST_F(Texture, FollowsThePlane) {
  VideoHarness harness(chain("location=" + pictures.red + " corners=\"" +
                             inverse::text_of(wall().corners_at(0)) + "\""),
                       kCaps, kCaps);
  double largest = 0;
  for (int n = 0; n < 40; ++n) {
    const Buffer out = harness.process_buffer(wall_frame(n));
    gpointer state = nullptr;
    GstMeta* meta = gst_buffer_iterate_meta_filtered(out.get(), &state,
                                                     GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE);
    ASSERT_NE(meta, nullptr) << n;
    const GstStructure* plane = gst_video_region_of_interest_meta_get_param(
        reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta), "plane");
    ASSERT_NE(plane, nullptr);
    const auto place = read_corners(gst_structure_get_string(plane, "corners"));
    ASSERT_TRUE(place);
    update_max(largest, corner_error(*place, wall().corners_at(n)));
  }
  EXPECT_LT(largest, 1);
  GstElement* texture = harness.find("intrinsictexture");
  EXPECT_EQ(stat<std::string>(texture, "plane"), "found");
  EXPECT_GT(stat<guint>(texture, "inliers"), 20U);
  EXPECT_EQ(element_messages(harness.bus(), "inverse-plane-found").size(), 1U);
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_F(Texture, IsFoundAgainAfterACutAndAFlush) {
  VideoHarness harness(chain("location=" + pictures.red + " corners=\"" +
                             inverse::text_of(wall().corners_at(0)) + "\""),
                       kCaps, kCaps);
  harness.process(wall_frame(0));
  const auto [x, y] = middle_of(wall().corners_at(0));
  for (int n = 0; n < 3; ++n)
    EXPECT_LE(largest_difference(harness.process(random_frame(kCaps, 5)), random_frame(kCaps, 5)),
              1)
        << "it hangs where no plane is";
  EXPECT_EQ(element_messages(harness.bus(), "inverse-plane-lost").size(), 1U);
  const auto back = harness.process(wall_frame(0), 5);
  EXPECT_TRUE(red_at(back, x, y));
  harness.flush();
  const auto [later_x, later_y] = middle_of(wall().corners_at(50));
  EXPECT_TRUE(red_at(harness.process(wall_frame(50)), later_x, later_y));
}

TEST_F(Texture, APlaneOfFewFeaturesStaysInAFrameThatComesAgain) {
  // Dots, which can be followed and have too few descriptors to be found by.
  cv::Mat table(kHeight, kWidth, CV_8UC3, cv::Scalar::all(150));
  for (int dot = 0; dot < 16; ++dot)
    cv::rectangle(table, cv::Rect(110 + dot % 4 * 27, 70 + dot / 4 * 27, 4, 4), cv::Scalar::all(60),
                  cv::FILLED);
  VideoHarness harness(chain("location=" + pictures.red + " " + kBox), kCaps, kCaps);
  for (int n = 0; n < 3; ++n) {
    EXPECT_TRUE(red_at(harness.process(bytes_of(table)), 130, 130)) << "seek " << n;
    harness.flush();
  }
  harness.process(bytes_of(table));
  harness.flush();
  EXPECT_FALSE(red_at(harness.process(flat()), 130, 130)) << "the table is gone";
}

TEST_F(Texture, StandsBehindWhatComesBeforeIt) {
  const auto covered = [&](const char* occlusion) {
    VideoHarness harness(
        chain("location=" + pictures.red + " " + kBox + " track=false occlusion=" + occlusion),
        kCaps, kCaps);
    std::vector<uint8_t> frame = flat();
    harness.process(frame, 10);
    for (int y = 90; y < 150; ++y)
      for (int x = 140; x < 180; ++x)
        for (size_t c = 0; c < 3; ++c)
          frame[3 * static_cast<size_t>(y * kWidth + x) + c] = c == 2 ? 160 : 40;
    const auto out = harness.process(frame, 2);
    EXPECT_TRUE(red_at(out, 115, 75)) << "around it";
    return red_at(out, 160, 120);
  };
  EXPECT_FALSE(covered("true"));
  EXPECT_TRUE(covered("false"));
}

TEST_F(Texture, IsFoundByAPosterOnTheWall) {
  const std::string path = write_picture(pictures.folder() / "poster.png", wall().poster());
  VideoHarness harness(chain("location=" + pictures.red + " poster=" + path), kCaps, kCaps);
  EXPECT_LE(largest_difference(harness.process(flat()), flat()), 1);
  std::vector<uint8_t> out;
  for (int n = 0; n < 6; ++n) out = harness.process(wall_frame(n));
  const auto [x, y] = middle_of(wall().corners_at(5));
  EXPECT_TRUE(red_at(out, x, y));
  EXPECT_FALSE(red_at(out, 5, 5));
}

TEST_F(Texture, APosterThatIsNotFoundIsWarnedOfOnce) {
  const std::string path = write_picture(pictures.folder() / "poster.png", wall().poster());
  VideoHarness harness(chain("location=" + pictures.red + " poster=" + path), kCaps, kCaps);
  harness.process(flat(), 99);
  EXPECT_TRUE(harness.warnings().empty());
  harness.process(flat(), 30);
  expect_one(harness.warnings(), "poster is not found", "set corners");
}

TEST_F(Texture, CornersThatCannotBeAreWarnedOfOnce) {
  for (const char* corners :
       {"10,10 10,10 10,10 10,10", "10,10 100,10 20,20 10,100", "10,10 100,100 100,10 10,100",
        "-500,-500 -400,-500 -400,-400 -500,-400", "10,10 1e30,10 100,100 10,100",
        "10,10 50,10 100,10 100,100"}) {
    VideoHarness harness(chain("location=" + pictures.red + " corners=\"" + corners + "\""), kCaps,
                         kCaps);
    for (int n = 0; n < 3; ++n)
      EXPECT_LE(largest_difference(harness.process(flat()), flat()), 1) << corners;
    expect_one(harness.warnings(), "no picture is hung there");
    EXPECT_TRUE(harness.errors().empty());
  }
  // Text that is no corners leaves those before.
  VideoHarness harness(chain("track=false location=" + pictures.red + " " + kBox), kCaps, kCaps);
  harness.process(flat());
  g_object_set(harness.find("intrinsictexture"), "corners", "here", nullptr);
  expect_one(harness.warnings(), "is not four corners");
  EXPECT_TRUE(red_at(harness.process(flat()), 160, 120));
}

TEST_F(Texture, APlaneWithoutFeaturesStaysAndIsWarnedOf) {
  VideoHarness harness(chain("location=" + pictures.red + " " + kBox), kCaps, kCaps);
  for (int n = 0; n < 3; ++n) EXPECT_TRUE(red_at(harness.process(flat()), 160, 120));
  expect_one(harness.warnings(), "too few", "track=false");
}

TEST_F(Texture, CornersAndOpacityChangeWhilePlaying) {
  VideoHarness harness(chain("track=false location=" + pictures.red + " " + kBox), kCaps, kCaps);
  GstElement* texture = harness.find("intrinsictexture");
  EXPECT_TRUE(red_at(harness.process(flat()), 160, 120));
  g_object_set(texture, "corners", "10,10 60,10 60,60 10,60", nullptr);
  auto out = harness.process(flat());
  EXPECT_FALSE(red_at(out, 160, 120));
  EXPECT_TRUE(red_at(out, 30, 30));
  g_object_set(texture, "opacity", 0.0F, nullptr);
  EXPECT_LE(largest_difference(harness.process(flat()), flat()), 1);
  g_object_set(texture, "opacity", 1.0F, "corners", "", nullptr);
  EXPECT_LE(largest_difference(harness.process(flat()), flat()), 1);
  EXPECT_EQ(property<std::string>(texture, "corners"), "");
}

TEST_F(Texture, AMaskConfinesIt) {
  const std::string first =
      "intrinsicdecomp light-color-slope=0 ! intrinsicrecolor strength=0 "
      "write-mask=true key=0xff3c5ac8 ! ";
  auto frame = flat();
  for (size_t i = 0; i < frame.size(); i += 3)
    if (static_cast<int>(i / 3) % kWidth < 160) {
      frame[i] = 60;
      frame[i + 1] = 90;
      frame[i + 2] = 200;
    }
  for (const char* use : {"true", "false"}) {
    VideoHarness harness(first + "intrinsictexture track=false location=" + pictures.red + " " +
                             kBox + "use-mask=" + use + " ! intrinsiccompose",
                         kCaps, kCaps);
    const auto out = harness.process(frame);
    EXPECT_TRUE(red_at(out, 130, 120));
    EXPECT_EQ(red_at(out, 190, 120), use == "false"s);
  }
}

TEST_F(Texture, CornersFollowTheMouse) {
  VideoHarness harness(chain("track=false location=" + pictures.red), kCaps, kCaps);
  GstElement* texture = harness.find("intrinsictexture");
  const auto send = [&](GstEvent* event) { harness.send_upstream(event); };
  const auto press = [&](double x, double y) {
    send(gst_navigation_event_new_mouse_button_press(1, x, y, GST_NAVIGATION_MODIFIER_NONE));
  };
  const auto move = [&](double x, double y) {
    send(gst_navigation_event_new_mouse_move(x, y, GST_NAVIGATION_MODIFIER_NONE));
  };
  const auto release = [&](double x, double y) {
    send(gst_navigation_event_new_mouse_button_release(1, x, y, GST_NAVIGATION_MODIFIER_NONE));
  };
  press(1, 1);  // before any frame
  release(50, 50);
  EXPECT_EQ(property<std::string>(texture, "corners"), "");
  harness.process(flat());
  // Without corners, a rectangle.
  press(200, 180);
  move(150, 100);
  move(NAN, INFINITY);
  release(100, 60);
  EXPECT_EQ(property<std::string>(texture, "corners"),
            "100.00,60.00 200.00,60.00 200.00,180.00 100.00,180.00");
  EXPECT_TRUE(red_at(harness.process(flat()), 150, 120));
  // A corner.
  press(203, 58);
  move(240, 50);
  release(250, 40);
  move(10, 10);
  EXPECT_EQ(property<std::string>(texture, "corners"),
            "100.00,60.00 250.00,40.00 200.00,180.00 100.00,180.00");
  harness.process(flat());
  // Far from any; through the others, where it would be no plane; and not at all.
  press(150, 120);
  release(10, 10);
  press(100, 60);
  move(300, 300);
  release(90, 50);
  EXPECT_EQ(property<std::string>(texture, "corners"),
            "90.00,50.00 250.00,40.00 200.00,180.00 100.00,180.00");
  g_object_set(texture, "drag", FALSE, nullptr);
  harness.process(flat());
  press(90, 50);
  release(70, 30);
  EXPECT_EQ(property<std::string>(texture, "corners"),
            "90.00,50.00 250.00,40.00 200.00,180.00 100.00,180.00");
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_F(Texture, AFileThatCannotBeReadIsOneErrorOrOneWarning) {
  const std::string video = "videotestsrc num-buffers=5 ! video/x-raw,width=64,height=48 ! ";
  for (const std::string& file :
       {pictures.folder() / "none.png", pictures.folder().path(), pictures.text})
    for (const char* name : {"location", "poster"}) {
      const auto result = run_line(video + "intrinsicdecomp ! intrinsictexture " + name + "=" +
                                   file + " ! intrinsiccompose ! fakesink");
      ASSERT_EQ(result.errors.size(), 1U) << file;
      expect_contains(result.first_error(), file);
      expect_contains(result.first_error(), "intrinsictexture");
    }
  VideoHarness harness(chain("track=false location=" + pictures.red + " " + kBox), kCaps, kCaps);
  harness.process(flat());
  GstElement* texture = harness.find("intrinsictexture");
  std::vector<std::string> warnings;
  g_object_set(texture, "location", pictures.text.c_str(), nullptr);
  for (int n = 0; n < 200 && warnings.empty(); ++n) {
    EXPECT_TRUE(red_at(harness.process(flat()), 160, 120)) << "the picture before stays";
    warnings = harness.warnings();
  }
  expect_one(warnings, pictures.text, "the picture before stays");
  g_object_set(texture, "location", pictures.green.c_str(), nullptr);
  std::vector<uint8_t> out;
  for (int n = 0; n < 200 && (out.empty() || !green_at(out, 160, 120)); ++n)
    out = harness.process(flat());
  EXPECT_TRUE(green_at(out, 160, 120));
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_F(Texture, NeedsADecomposerBeforeIt) {
  const auto result = run_line(
      "videotestsrc num-buffers=3 ! video/x-raw,width=64,height=48 ! intrinsictexture ! "
      "intrinsiccompose ! fakesink");
  ASSERT_FALSE(result.errors.empty());
  expect_contains(result.first_error(), "insert intrinsicdecomp before it");
}

TEST_F(Texture, TakesFramesOfAnySize) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {15, 10}, {33, 1}, {349, 287}})
    for (const char* format : {"RGB", "GRAY8"}) {
      const std::string caps = VideoHarness::caps(format, width, height);
      VideoHarness harness("globalintrinsic ! intrinsictexture location=" + pictures.red +
                               " corners=\"-5,-5 400,-5 400,400 -5,400\" ! intrinsiccompose",
                           caps, caps);
      for (unsigned n = 0; n < 3; ++n)
        EXPECT_FALSE(harness.process(random_frame(caps, n)).empty()) << caps;
      EXPECT_TRUE(harness.errors().empty());
    }
}

TEST_F(Texture, OtherCapsAreAnotherPictureOfTheSamePlane) {
  VideoHarness harness(chain("location=" + pictures.red + " corners=\"" +
                             inverse::text_of(wall().corners_at(0)) + "\""),
                       kCaps, "video/x-raw,format=RGB");
  harness.process(wall_frame(0));
  harness.set_src_caps(VideoHarness::caps("RGB", 2 * kWidth, 2 * kHeight));
  cv::Mat larger;
  cv::resize(wall().at(0).picture, larger, {2 * kWidth, 2 * kHeight}, 0, 0, cv::INTER_CUBIC);
  const auto out = harness.process(bytes_of(larger), 4);
  ASSERT_EQ(out.size(), bytes_of(larger).size());
  const auto [x, y] = middle_of(wall().corners_at(0));
  EXPECT_GT(excess(out, 2 * x, 2 * y, 0, 2 * kWidth),
            excess(bytes_of(larger), 2 * x, 2 * y, 0, 2 * kWidth) + 10);
  EXPECT_EQ(stat<std::string>(harness.find("intrinsictexture"), "plane"), "found");
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(Texture, AStreamHangsFrameByFrameAndItsLastOneStays) {
  // Three frames of red, then the stream ends; the video goes on.
  const auto result = run_line(
      "videotestsrc num-buffers=12 pattern=solid-color foreground-color=0xff808080 ! "
      "video/x-raw,format=RGB,width=320,height=240,framerate=10/1 ! "
      "intrinsicdecomp light-color-slope=0 ! intrinsictexture name=t track=false " +
      kBox +
      " ! intrinsiccompose ! video/x-raw,format=RGB ! appsink name=out sync=true "
      "videotestsrc num-buffers=3 pattern=solid-color foreground-color=0xffff0000 ! "
      "video/x-raw,format=I420,width=48,height=100,framerate=10/1 ! t.texture");
  EXPECT_TRUE(result.eos) << result.first_error();
  ASSERT_EQ(result.frames.size(), 12U);
  EXPECT_TRUE(result.warnings.empty());
  for (size_t n = 6; n < 12; ++n) EXPECT_TRUE(red_at(result.frames[n], 160, 120)) << n;
  EXPECT_FALSE(red_at(result.frames[11], 50, 120));
}

TEST_F(Texture, AStreamThatNeverStartsLeavesFramesAsTheyAre) {
  const auto result = run_line(
      "videotestsrc num-buffers=5 ! video/x-raw,format=RGB,width=320,height=240 ! intrinsicdecomp "
      "! intrinsictexture name=t track=false " +
      kBox + " ! intrinsiccompose ! video/x-raw,format=RGB ! appsink name=out sync=false " +
      "appsrc ! video/x-raw,format=RGBA,width=16,height=16,framerate=10/1 ! t.texture");
  EXPECT_TRUE(result.eos) << result.first_error();
  ASSERT_EQ(result.frames.size(), 5U);
  EXPECT_EQ(result.frames[4].size(), 3U * kWidth * kHeight);
}

TEST_F(Texture, AStreamMayChangeItsSizeAndFormat) {
  const std::string solid = "videotestsrc num-buffers=4 pattern=solid-color foreground-color=";
  const auto result = run_line(
      "videotestsrc num-buffers=14 pattern=solid-color foreground-color=0xff808080 ! "
      "video/x-raw,format=RGB,width=320,height=240,framerate=10/1 ! intrinsicdecomp "
      "light-color-slope=0 ! intrinsictexture name=t track=false " +
      kBox +
      " ! intrinsiccompose ! video/x-raw,format=RGB ! appsink name=out sync=true "
      "concat name=c ! t.texture " +
      solid + "0xffff0000 ! video/x-raw,format=RGB,width=20,height=20,framerate=10/1 ! c. " +
      solid + "0xff00ff00 ! video/x-raw,format=NV12,width=64,height=32,framerate=10/1 ! c.");
  EXPECT_TRUE(result.eos) << result.first_error();
  ASSERT_EQ(result.frames.size(), 14U);
  EXPECT_TRUE(red_at(result.frames[3], 160, 120));
  EXPECT_TRUE(green_at(result.frames[13], 160, 120));
}

TEST_F(Texture, ThePadIsTakenAndGivenBackWhilePlaying) {
  VideoHarness harness(chain("track=false location=" + pictures.green + " " + kBox), kCaps, kCaps);
  GstElement* texture = harness.find("intrinsictexture");
  EXPECT_TRUE(green_at(harness.process(flat()), 160, 120));
  GstPad* pad = gst_element_request_pad_simple(texture, "texture");
  ASSERT_NE(pad, nullptr);
  // More than it holds: its thread waits, and stops waiting when the pad goes.
  gst_pad_send_event(pad, gst_event_new_stream_start("texture"));
  const std::string caps = VideoHarness::caps("RGB", 8, 8);
  GstCaps* fixed = gst_caps_from_string(caps.c_str());
  gst_pad_send_event(pad, gst_event_new_caps(fixed));
  gst_caps_unref(fixed);
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_pad_send_event(pad, gst_event_new_segment(&segment));
  std::thread pusher([&] {
    for (int n = 0;; ++n) {
      auto red = flat_frame(caps, 0);
      for (size_t i = 0; i < red.size(); i += 3) red[i] = 255;
      GstBuffer* buffer = gst_buffer_new_memdup(red.data(), red.size());
      GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(n) * GST_SECOND / 25;
      if (gst_pad_chain(pad, buffer) != GST_FLOW_OK) break;
    }
  });
  std::vector<uint8_t> out;
  for (int n = 0; n < 200 && (out.empty() || !red_at(out, 160, 120)); ++n)
    out = harness.process(flat());
  EXPECT_TRUE(red_at(out, 160, 120));
  gst_element_release_request_pad(texture, pad);
  pusher.join();
  gst_object_unref(pad);
  EXPECT_TRUE(red_at(harness.process(flat()), 160, 120)) << "its last frame stays";
  EXPECT_TRUE(harness.errors().empty());
}

}  // namespace inverse::testing
