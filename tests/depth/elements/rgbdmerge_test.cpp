// SPDX-License-Identifier: LGPL-2.1-or-later
// rgbdmerge: pairs by time, calibration, and what has no partner.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "gst/depth/calibration.hpp"
#include "recorded.hpp"
#include "tests/has_element.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

struct Merged {
  LineResult line;
  std::vector<RgbdBuffer> pairs;
  guint64 merged = 0, unpaired = 0, depth_dropped = 0, posed = 0;
};

constexpr const char* kColor = "videotestsrc num-buffers=10 ! video/x-raw,width=64,height=48";
constexpr const char* kDepth =
    "videotestsrc num-buffers=10 pattern=ball ! video/x-raw,format=GRAY16_LE,width=32,height=24";

Merged merge(const std::string& settings, const std::string& color = kColor,
             const std::string& depth = kDepth, const std::string& behind = "") {
  Merged merged;
  merged.line = run_line(
      "rgbdmerge name=merge " + settings + " ! " + behind + "appsink name=out sync=false " + color +
          " ! queue ! merge.sink " + depth + " ! queue ! merge.depth",
      60, [&](GstElement* pipeline) {
        watch_buffers(find_element(pipeline, "out"), "sink", [&, pipeline](GstBuffer* buffer) {
          merged.pairs.push_back(rgbd_buffer(buffer));
          GstElement* element = find_element(pipeline, "merge");
          merged.merged = stat<guint64>(element, "merged");
          merged.unpaired = stat<guint64>(element, "unpaired");
          merged.depth_dropped = stat<guint64>(element, "depth-dropped");
          merged.posed = stat<guint64>(element, "posed");
        });
      });
  return merged;
}

TEST(RgbdMerge, AttachesTheDepthOfTheSameTime) {
  const Merged merged = merge("depth-unit=0.0005 fx=50");
  ASSERT_EQ(merged.pairs.size(), 10U) << merged.line.first_error();
  EXPECT_TRUE(merged.line.warnings.empty());
  const LineResult depth = run_line(std::string(kDepth) + " ! appsink name=out sync=false");
  for (size_t n = 0; n < 10; ++n) {
    const RgbdBuffer& pair = merged.pairs[n];
    ASSERT_TRUE(pair.has_depth) << n;
    EXPECT_EQ(pair.meta.width, 32U);
    EXPECT_EQ(pair.meta.unit, 0.0005);
    EXPECT_EQ(pair.meta.fx, 25) << "in pixels of the depth image";
    EXPECT_EQ(pair.meta.cx, 15.5);
    EXPECT_EQ(0, memcmp(pair.steps.data(), depth.frames[n].data(), 2 * pair.steps.size())) << n;
  }
}

// The image before a change may be the nearest to a picture after it.
TEST(RgbdMerge, AnImageIsReadByTheCapsThatItCameWith) {
  const auto depth = [](int width, int height) {
    return "videotestsrc num-buffers=5 pattern=ball ! video/x-raw,format=GRAY16_LE,width=" +
           std::to_string(width) + ",height=" + std::to_string(height) + ",framerate=30/1";
  };
  const std::string small = depth(32, 24), large = depth(64, 48);
  for (const auto& [before, after] : {std::pair{small, large}, {large, small}}) {
    // Pictures come 10 ms after the depth image of their number.
    const Merged merged = merge("max-difference=100",
                                "videotestsrc num-buffers=10 timestamp-offset=10000000 ! "
                                "video/x-raw,width=64,height=48",
                                "concat name=c " + before + " ! c. " + after + " ! c. c.");
    ASSERT_TRUE(merged.line.eos) << merged.line.first_error();
    ASSERT_EQ(merged.pairs.size(), 10U);
    const LineResult first = run_line(before + " ! appsink name=out sync=false"),
                     second = run_line(after + " ! appsink name=out sync=false");
    for (size_t n = 0; n < 10; ++n) {
      const auto& image = n < 5 ? first.frames[n] : second.frames[n - 5];
      ASSERT_EQ(2 * merged.pairs[n].steps.size(), image.size()) << n;
      EXPECT_EQ(0, memcmp(merged.pairs[n].steps.data(), image.data(), image.size())) << n;
    }
  }
}

// Depth has half the rate: every second picture has none within 5 ms.
TEST(RgbdMerge, DropsAndCountsWhatHasNoPartner) {
  const std::string slow =
      "videotestsrc num-buffers=5 ! "
      "video/x-raw,format=GRAY16_LE,width=32,height=24,framerate=15/1";
  const Merged dropped = merge("max-difference=5", kColor, slow);
  EXPECT_EQ(dropped.pairs.size(), 5U) << dropped.line.first_error();
  for (const RgbdBuffer& pair : dropped.pairs) EXPECT_TRUE(pair.has_depth);
  const Merged passed = merge("max-difference=5 unpaired=pass", kColor, slow);
  ASSERT_EQ(passed.pairs.size(), 10U);
  EXPECT_EQ(passed.merged, 5U);
  EXPECT_TRUE(passed.pairs[4].has_depth);
  EXPECT_FALSE(passed.pairs[5].has_depth);
  const Merged near = merge("max-difference=40", kColor, slow);
  EXPECT_EQ(near.pairs.size(), 10U);
  const Merged fast = merge("", kColor,
                            "videotestsrc num-buffers=20 ! "
                            "video/x-raw,format=GRAY16_LE,width=32,height=24,framerate=60/1");
  EXPECT_EQ(fast.pairs.size(), 10U);
  EXPECT_GE(fast.depth_dropped, 8U);
}

TEST(RgbdMerge, SaysThatStreamsAreApart) {
  const Merged merged =
      merge("max-difference=1", "videotestsrc num-buffers=40 ! video/x-raw,width=64,height=48",
            "videotestsrc num-buffers=40 timestamp-offset=10000000000 ! "
            "video/x-raw,format=GRAY16_LE,width=32,height=24");
  EXPECT_TRUE(merged.pairs.empty());
  ASSERT_EQ(merged.line.warnings.size(), 1U) << merged.line.first_error();
  EXPECT_NE(merged.line.warnings[0].find("max-difference"), std::string::npos);
  EXPECT_TRUE(merged.line.eos);
}

// Depth at another rate is near some pictures only, which is said once.
TEST(RgbdMerge, SaysThatRatesDiffer) {
  const Merged merged = merge("max-difference=10",
                              "videotestsrc num-buffers=96 ! "
                              "video/x-raw,width=64,height=48,framerate=10/1",
                              "videotestsrc num-buffers=96 ! "
                              "video/x-raw,format=GRAY16_LE,width=32,height=24,framerate=9/1");
  EXPECT_GT(merged.merged, 5U);
  EXPECT_LT(merged.merged, 48U);
  ASSERT_EQ(merged.line.warnings.size(), 1U) << merged.line.first_error();
  EXPECT_NE(merged.line.warnings[0].find("of 30 pictures"), std::string::npos);
  EXPECT_NE(merged.line.warnings[0].find("ms away"), std::string::npos) << merged.line.warnings[0];
}

TEST(RgbdMerge, PicturesKeepTheFormatThatIsWanted) {
  const Merged merged =
      merge("", std::string(kColor) + " ! videoconvert", kDepth, "video/x-raw,format=NV12 ! ");
  EXPECT_EQ(merged.pairs.size(), 10U) << merged.line.first_error();
  EXPECT_EQ(GST_VIDEO_INFO_FORMAT(&merged.line.info), GST_VIDEO_FORMAT_NV12);
}

TEST(RgbdMerge, TakesPosesFromAFile) {
  const TemporaryFolder folder;
  std::string lines = "# time tx ty tz qx qy qz qw\n";
  for (int n = 0; n < 5; ++n)  // up to the fifth picture
    lines += std::to_string(50 + n / 30.0) + " " + std::to_string(n) + " 2 3 0 0 1 0\n";
  const std::string file = folder.write("poses.txt", lines + "50.5 1 2\n");
  const Merged merged = merge("poses-start=50 max-difference=5 poses=" + file);
  ASSERT_EQ(merged.pairs.size(), 10U) << merged.line.first_error();
  ASSERT_EQ(merged.line.warnings.size(), 1U);
  EXPECT_NE(merged.line.warnings[0].find("line 7 is not"), std::string::npos);
  for (size_t n = 0; n < 10; ++n) {
    const GstInverseDepthMeta& meta = merged.pairs[n].meta;
    ASSERT_EQ(meta.posed, n < 5) << n;
    if (n >= 5) continue;
    EXPECT_NEAR(meta.pose[3], double(n), 1e-3);
    EXPECT_EQ(meta.pose[7], 2);
    EXPECT_NEAR(meta.pose[0], -1, 1e-12) << "half a turn about z";
    EXPECT_NEAR(meta.pose[10], 1, 1e-12);
  }
  EXPECT_EQ(merged.posed, 5U);
  const Merged apart =
      merge("poses=" + file, "videotestsrc num-buffers=35 ! video/x-raw,width=64,height=48",
            "videotestsrc num-buffers=35 ! video/x-raw,format=GRAY16_LE,width=32,height=24");
  EXPECT_EQ(apart.pairs.size(), 35U);
  ASSERT_EQ(apart.line.warnings.size(), 2U);
  EXPECT_NE(apart.line.warnings[1].find("set poses-start"), std::string::npos);
  EXPECT_NE(merge("poses=/nowhere.txt").line.first_error().find("/nowhere.txt"), std::string::npos);
}

TEST(RgbdMerge, KeepsThePoseThatPicturesOrDepthBring) {
  const TemporaryFolder folder;
  const std::string camera = R"({"size":[64,48],"matrix":[[60,0,31.5],[0,60,23.5],[0,0,1]]})";
  const std::string file = folder.write(
      "c.json", R"({"color":)" + camera + R"(,"depth":)" + camera +
                    R"(,"rotation":[[0,-1,0],[1,0,0],[0,0,1]],"translation":[0.5,0.25,0]})");
  const std::string room = "rgbdtestsrc is-live=false samples=1 num-buffers=3 ! video/x-raw,",
                    size = ",width=64,height=48,framerate=30/1", posed = room + "format=RGB" + size,
                    posed_depth = room + "format=GRAY16_LE" + size,
                    plain = "videotestsrc num-buffers=3 ! video/x-raw,format=RGB" + size,
                    plain_depth =
                        "videotestsrc num-buffers=3 ! video/x-raw,format=GRAY16_LE" + size;
  const Merged both = merge("", posed, plain_depth), depth = merge("", plain, posed_depth),
               calibrated = merge("calibration=" + file, plain, posed_depth),
               none = merge("", plain, plain_depth);
  for (const Merged* merged : {&both, &depth, &calibrated, &none})
    ASSERT_EQ(merged->pairs.size(), 3U) << merged->line.first_error();
  for (size_t n = 0; n < 3; ++n) {
    EXPECT_FALSE(none.pairs[n].meta.posed);
    ASSERT_TRUE(both.pairs[n].meta.posed);
    ASSERT_TRUE(depth.pairs[n].meta.posed);
    ASSERT_TRUE(calibrated.pairs[n].meta.posed);
    const gdouble *from = depth.pairs[n].meta.pose, *to = calibrated.pairs[n].meta.pose;
    EXPECT_NE(from[7], 0);
    EXPECT_TRUE(std::equal(from, from + 12, both.pairs[n].meta.pose));
    // A point x of the depth camera is (0.5 - x1, 0.25 + x0, x2) in the color camera's axes.
    const double x[] = {0.3, -0.2, 1.7}, y[] = {0.7, 0.55, 1.7};
    for (size_t r = 0; r < 3; ++r)
      EXPECT_NEAR(
          from[4 * r] * x[0] + from[4 * r + 1] * x[1] + from[4 * r + 2] * x[2] + from[4 * r + 3],
          to[4 * r] * y[0] + to[4 * r + 1] * y[1] + to[4 * r + 2] * y[2] + to[4 * r + 3], 1e-9);
  }
}

std::pair<LineResult, std::vector<RgbdBuffer>> play_matroska(const std::string& file,
                                                             const std::string& unit) {
  std::vector<RgbdBuffer> played;
  LineResult line = run_line(
      "rgbdmerge name=merge depth-unit=" + unit +
          " ! appsink name=out sync=false filesrc location=" + file +
          " ! matroskademux name=demux demux.video_0 ! queue ! decodebin ! merge.sink "
          "demux.video_1 ! queue ! avdec_ffv1 ! video/x-raw,format=GRAY16_LE ! merge.depth",
      60, [&](GstElement* pipeline) {
        watch_buffers(find_element(pipeline, "out"), "sink",
                      [&](GstBuffer* buffer) { played.push_back(rgbd_buffer(buffer)); });
      });
  return {std::move(line), std::move(played)};
}

// The lines of the manual: a recording in a Matroska file has the depth that was written.
TEST(RgbdMerge, PlaysMatroska) {
  if (!has_element("avenc_ffv1")) GTEST_SKIP() << "there is no gst-libav";
  const TemporaryFolder folder;
  for (int n = 0; n < 5; ++n) {
    const std::string number = "/000" + std::to_string(n) + ".png";
    write_color(folder, "color" + number, static_cast<uint8_t>(50 * n));
    write_depth(folder, "depth" + number, static_cast<uint16_t>(9999 * n));
  }
  const std::string images = " caps=image/png,framerate=30/1 ! pngdec ! videoconvert ! ";
  ASSERT_TRUE(
      run_line("matroskamux name=mux ! filesink location=" + (folder / "r.mkv") +
               " multifilesrc location=" + (folder / "color/%04d.png") + images +
               "vp8enc ! queue ! mux. multifilesrc location=" + (folder / "depth/%04d.png") +
               images + "video/x-raw,format=GRAY16_LE ! avenc_ffv1 ! queue ! mux.")
          .eos);
  const auto [line, played] = play_matroska(folder / "r.mkv", "0.0002");
  ASSERT_EQ(played.size(), 5U) << line.first_error();
  for (size_t n = 0; n < 5; ++n) {
    ASSERT_TRUE(played[n].has_depth);
    EXPECT_EQ(played[n].meta.unit, 0.0002);
    EXPECT_EQ(played[n].steps[1], 65535);
    for (size_t i = 2; i < 64 * 48; ++i)
      ASSERT_EQ(played[n].steps[i], static_cast<uint16_t>(9999 * n + i));
  }
}

TEST(RgbdMerge, PlaysARecordingOfTheRoom) {
  if (!has_element("avenc_ffv1")) GTEST_SKIP() << "there is no gst-libav";
  const TemporaryFolder folder;
  const std::string room = "rgbdtestsrc is-live=false samples=1 num-buffers=3 ",
                    size = ",width=64,height=48,framerate=30/1 ! ";
  ASSERT_TRUE(run_line("matroskamux name=mux ! filesink location=" + (folder / "r.mkv") + " " +
                       room + "! video/x-raw" + size + "videoconvert ! vp8enc ! queue ! mux. " +
                       room +
                       "show=depth max-depth=8 ! video/x-raw,format=GRAY16_LE,"
                       "colorimetry=1:4:1:1" +
                       size + "avenc_ffv1 ! queue ! mux.")
                  .eos);
  const auto [line, played] = play_matroska(folder / "r.mkv", "0.000122072175");
  std::vector<RgbdBuffer> exact;
  run_line(room + "depth-noise=0 ! video/x-raw" + size + "appsink name=out sync=false", 60,
           [&](GstElement* pipeline) {
             watch_buffers(find_element(pipeline, "out"), "sink",
                           [&](GstBuffer* buffer) { exact.push_back(rgbd_buffer(buffer)); });
           });
  ASSERT_EQ(played.size(), 3U) << line.first_error();
  ASSERT_EQ(exact.size(), 3U);
  for (size_t n = 0; n < 3; ++n)
    for (size_t i = 0; i < 64 * 48; ++i)
      ASSERT_NEAR(played[n].steps.at(i) * played[n].meta.unit, exact[n].steps.at(i) * 0.001, 1e-3)
          << n << " " << i;
}

// The line of the manual, up to what the source says without a device.
TEST(RgbdMerge, OpenNi2PlaysOrSaysThatItCannot) {
  GstElementFactory* factory = gst_element_factory_find("openni2src");
  if (!factory) GTEST_SKIP() << "there is no openni2src";
  gst_object_unref(factory);
  Pipeline pipeline(
      "rgbdmerge name=merge ! fakesink openni2src sourcetype=color ! merge.sink "
      "openni2src sourcetype=depth ! merge.depth");
  EXPECT_TRUE(pipeline.set(GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE ||
              pipeline.reaches(GST_STATE_PAUSED));
}

class CalibrationFile : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  const std::string& write(const std::string& text) {
    std::ofstream(path_) << text;
    return path_;
  }
  std::string path_ = std::filesystem::temp_directory_path() /
                      ("calibration-" + std::to_string(getpid()) + ".json");
};

constexpr const char* kCamera = R"("size":[64,48],"matrix":[[60,0,31.5],[0,60,23.5],[0,0,1]])";

TEST_F(CalibrationFile, BringsDepthToTheColorCamera) {
  // 10 cm to the right of the depth camera, so that what is 1 m away moves by 6 pixels to the left.
  const Calibration calibration =
      read_calibration(write(std::string(R"({"color":{)") + kCamera + R"(},"depth":{)" + kCamera +
                             R"(,"unit":0.001},"translation":[-0.1,0,0]})"));
  const Registration registration(calibration, {64, 48});
  std::vector<uint16_t> depth(64 * 48, 2000), registered;
  for (size_t y = 20; y < 28; ++y)
    for (size_t x = 30; x < 38; ++x) depth[y * 64 + x] = 1000;
  depth[0] = 65535;
  registration.run(reinterpret_cast<const uint8_t*>(depth.data()), 128, 0.001, registered);
  const auto at = [&](size_t x, size_t y) { return registered[y * 64 + x]; };
  EXPECT_EQ(at(25, 24), 1000) << "nearer surfaces hide what is behind";
  EXPECT_EQ(at(30, 24), 1000);
  EXPECT_EQ(at(20, 24), 2000);
  EXPECT_EQ(at(33, 24), 0) << "nobody has seen what is behind the square";
  EXPECT_EQ(at(40, 24), 2000);
  EXPECT_EQ(at(63, 24), 0) << "outside of the depth camera's view";
}

// Pixels of a distorted lens come back to where they were.
TEST_F(CalibrationFile, DistortionIsThatOfOpenCv) {
  const std::string lens = std::string(kCamera) + R"(,"distortion":[-0.25,0.08,0.002,-0.001,0.01])";
  const Registration registration(
      read_calibration(write(R"({"color":{)" + lens + R"(},"depth":{)" + lens + "}}")), {64, 48});
  std::vector<uint16_t> depth(64 * 48, 0), registered;
  depth[5 * 64 + 7] = 1500;
  registration.run(reinterpret_cast<const uint8_t*>(depth.data()), 128, 0.001, registered);
  EXPECT_EQ(registered[5 * 64 + 7], 1500);
  EXPECT_LE(std::count(registered.begin(), registered.end(), 1500), 4);
}

TEST_F(CalibrationFile, WrongFilesAreErrors) {
  const std::string camera = std::string("{") + kCamera + "}",
                    singular = R"({"size":[64,48],"matrix":[[0,0,31],[0,60,23],[0,0,1]]})";
  const std::pair<std::string, const char*> files[] = {
      {"no json", "is not valid JSON at line 1"},
      {"{}", "is no calibration: key 'color' not found"},
      {R"({"color":)" + camera + "}", "is no calibration"},
      {R"({"color":)" + singular + R"(,"depth":)" + camera + "}", "singular"},
      {R"({"color":)" + camera + R"(,"depth":)" + camera +
           R"(,"rotation":[[1,0,0],[0,1,0],[0,0,0]]})",
       "no rotation"},
      {R"({"color":)" + camera + R"(,"depth":{)" + kCamera + R"(,"unit":0}})", "unit"},
  };
  for (const auto& [text, said] : files) {
    const Merged merged = merge("calibration=" + write(text));
    EXPECT_NE(merged.line.first_error().find(said), std::string::npos)
        << text << ": " << merged.line.first_error();
  }
  EXPECT_NE(merge("calibration=/nowhere/c.json").line.first_error().find("cannot be read"),
            std::string::npos);
}

}  // namespace
}  // namespace inverse::testing
