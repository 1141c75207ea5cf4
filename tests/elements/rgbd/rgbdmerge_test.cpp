// SPDX-License-Identifier: LGPL-2.1-or-later
// rgbdmerge: pairs by time, calibration, and what has no partner.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "gst/rgbd/calibration.hpp"
#include "gst/rgbd/meta/inverse_depth_meta.h"
#include "tests/elements/element_test.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

struct Pair {
  GstClockTime time = 0;
  bool has_depth = false;
  GstInverseDepthMeta meta{};  // without its image
  std::vector<uint16_t> steps;
};
struct Merged {
  LineResult line;
  std::vector<Pair> pairs;
  guint64 merged = 0, unpaired = 0, depth_dropped = 0;
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
          Pair pair{.time = GST_BUFFER_PTS(buffer)};
          if (const GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer)) {
            pair.has_depth = true;
            pair.meta = *meta;
            pair.steps.resize(size_t{meta->width} * meta->height);
            gst_buffer_extract(meta->depth, 0, pair.steps.data(), 2 * pair.steps.size());
          }
          merged.pairs.push_back(std::move(pair));
          GstStructure* stats = nullptr;
          g_object_get(find_element(pipeline, "merge"), "stats", &stats, nullptr);
          gst_structure_get(stats, "merged", G_TYPE_UINT64, &merged.merged, "unpaired",
                            G_TYPE_UINT64, &merged.unpaired, "depth-dropped", G_TYPE_UINT64,
                            &merged.depth_dropped, nullptr);
          gst_structure_free(stats);
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
    const Pair& pair = merged.pairs[n];
    ASSERT_TRUE(pair.has_depth) << n;
    EXPECT_EQ(pair.meta.width, 32U);
    EXPECT_EQ(pair.meta.unit, 0.0005);
    EXPECT_EQ(pair.meta.fx, 25) << "in pixels of the depth image";
    EXPECT_EQ(pair.meta.cx, 15.5);
    EXPECT_EQ(0, memcmp(pair.steps.data(), depth.frames[n].data(), 2 * pair.steps.size())) << n;
  }
}

// Depth has half the rate: every second picture has none within 5 ms.
TEST(RgbdMerge, DropsAndCountsWhatHasNoPartner) {
  const std::string slow =
      "videotestsrc num-buffers=5 ! "
      "video/x-raw,format=GRAY16_LE,width=32,height=24,framerate=15/1";
  const Merged dropped = merge("max-difference=5", kColor, slow);
  EXPECT_EQ(dropped.pairs.size(), 5U) << dropped.line.first_error();
  for (const Pair& pair : dropped.pairs) EXPECT_TRUE(pair.has_depth);
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

TEST(RgbdMerge, PicturesKeepTheFormatThatIsWanted) {
  const Merged merged =
      merge("", std::string(kColor) + " ! videoconvert", kDepth, "video/x-raw,format=NV12 ! ");
  EXPECT_EQ(merged.pairs.size(), 10U) << merged.line.first_error();
  EXPECT_EQ(GST_VIDEO_INFO_FORMAT(&merged.line.info), GST_VIDEO_FORMAT_NV12);
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
  registration.run(reinterpret_cast<const uint8_t*>(depth.data()), 128, registered);
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
  registration.run(reinterpret_cast<const uint8_t*>(depth.data()), 128, registered);
  EXPECT_EQ(registered[5 * 64 + 7], 1500);
  EXPECT_LE(std::count(registered.begin(), registered.end(), 1500), 4);
}

TEST_F(CalibrationFile, WrongFilesAreErrors) {
  const std::string camera = std::string("{") + kCamera + "}",
                    singular = R"({"size":[64,48],"matrix":[[0,0,31],[0,60,23],[0,0,1]]})";
  const std::pair<std::string, const char*> files[] = {
      {"no json", "is no calibration"},
      {"{}", "is no calibration"},
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
  EXPECT_NE(merge("calibration=/nowhere/c.json").line.first_error().find("cannot read"),
            std::string::npos);
}

}  // namespace
}  // namespace inverse::testing
