// SPDX-License-Identifier: LGPL-2.1-or-later
// rgbdtestsrc, by whole lines.
#include <algorithm>
#include <cmath>

#include "gst/inverse/inverse_depth_meta.h"
#include "tests/elements/element_test.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

/// The depth of a frame.
struct Depth {
  GstClockTime time = 0;
  GstInverseDepthMeta meta{};  // without its image
  std::vector<double> meters;
};

struct Recorded {
  LineResult line;
  std::vector<Depth> depths;
};

constexpr const char* kLinear =
    "video/x-raw,format=RGBA64_LE,colorimetry=(string)1:1:1:1,width=64,height=48";

/// `source` is what follows "rgbdtestsrc", `more` what comes before the sink.
Recorded record(const std::string& source, const std::string& more = kLinear) {
  Recorded recorded;
  recorded.line = run_line(
      "rgbdtestsrc is-live=false " + source + " ! " + more + " ! appsink name=out sync=false", 120,
      [&](GstElement* pipeline) {
        watch_buffers(find_element(pipeline, "out"), "sink", [&](GstBuffer* buffer) {
          const GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer);
          if (!meta) return;
          Depth depth{GST_BUFFER_PTS(buffer), *meta, {}};
          GstMapInfo map;
          ASSERT_TRUE(gst_buffer_map(meta->depth, &map, GST_MAP_READ));
          ASSERT_EQ(map.size, size_t{meta->stride} * meta->height);
          for (guint y = 0; y < meta->height; ++y)
            for (guint x = 0; x < meta->width; ++x)
              depth.meters.push_back(
                  GST_READ_UINT16_LE(map.data + size_t{y} * meta->stride + size_t{2} * x) *
                  meta->unit);
          gst_buffer_unmap(meta->depth, &map);
          recorded.depths.push_back(depth);
        });
      });
  return recorded;
}

std::vector<double> samples(const std::vector<uint8_t>& frame) {
  std::vector<double> values(frame.size() / 2);
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = GST_READ_UINT16_LE(&frame[2 * i]) / 65535.0;
  return values;
}

TEST(RgbdTestSrc, ColorIsReflectanceTimesShading) {
  const std::string settings = "num-buffers=2 samples=1 path=wall show=";
  const Recorded color = record(settings + "color"), reflectance = record(settings + "reflectance"),
                 shading = record(settings + "shading");
  ASSERT_EQ(color.line.frames.size(), 2U) << color.line.first_error();
  for (size_t n = 0; n < 2; ++n) {
    const auto c = samples(color.line.frames[n]), r = samples(reflectance.line.frames[n]),
               s = samples(shading.line.frames[n]);
    double brightest = 0;
    for (size_t i = 0; i < c.size(); ++i) {
      if (i % 4 == 3) continue;
      EXPECT_NEAR(c[i], r[i] * s[i], 2e-4);
      brightest = std::max(brightest, c[i]);
    }
    EXPECT_GT(brightest, 0.2);
    EXPECT_LT(brightest, 1);
  }
}

TEST(RgbdTestSrc, DepthGoesWithThePicture) {
  const Recorded exact = record("num-buffers=2 depth-noise=0 show=depth max-depth=6");
  ASSERT_EQ(exact.depths.size(), 2U) << exact.line.first_error();
  EXPECT_EQ(exact.depths[1].time, GST_SECOND / 30);
  for (size_t n = 0; n < 2; ++n) {
    const Depth& depth = exact.depths[n];
    EXPECT_EQ(depth.meta.width, 64U);
    EXPECT_EQ(depth.meta.height, 48U);
    EXPECT_EQ(depth.meta.cx, 31.5);
    EXPECT_NEAR(depth.meta.fx, 32 / std::tan(31 * 3.14159265 / 180), 1e-3);
    EXPECT_TRUE(depth.meta.posed);
    const auto shown = samples(exact.line.frames[n]);
    for (size_t i = 0; i < depth.meters.size(); ++i)
      EXPECT_NEAR(depth.meters[i], 6 * shown[4 * i], 1e-3);
  }
  EXPECT_NE(exact.depths[0].meta.pose[3], exact.depths[1].meta.pose[3]) << "the camera moves";
  const auto has_holes = [](const Recorded& of) {
    return std::count(of.depths[0].meters.begin(), of.depths[0].meters.end(), 0.0) > 10;
  };
  EXPECT_FALSE(has_holes(exact));
  const Recorded noisy = record("num-buffers=1"), near = record("num-buffers=1 max-depth=1.2");
  EXPECT_NE(noisy.depths[0].meters, exact.depths[0].meters);
  EXPECT_TRUE(has_holes(near));
  EXPECT_LE(*std::max_element(near.depths[0].meters.begin(), near.depths[0].meters.end()), 1.2);
  EXPECT_EQ(record("num-buffers=1").depths[0].meters, noisy.depths[0].meters);
  EXPECT_NE(record("num-buffers=1 seed=7").depths[0].meters, noisy.depths[0].meters);
}

// A point of the world has the place that pose and depth of either frame say.
TEST(RgbdTestSrc, PosesAreThoseOfTheCamera) {
  const Recorded still = record("num-buffers=1 depth-noise=0 path=still"),
                 moved = record("num-buffers=8 depth-noise=0 path=orbit speed=2");
  ASSERT_EQ(moved.depths.size(), 8U) << moved.line.first_error();
  const auto world = [](const Depth& depth, int x, int y) {
    const double z = depth.meters[size_t(y) * 64 + size_t(x)];
    const double p[] = {z * (x - depth.meta.cx) / depth.meta.fx,
                        z * (y - depth.meta.cy) / depth.meta.fy, z};
    std::vector<double> at;
    for (size_t r = 0; r < 3; ++r) {
      const gdouble* row = depth.meta.pose + 4 * r;
      at.push_back(row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
    }
    return at;
  };
  // The lower corners of the picture see the floor, the middle the table.
  for (const Depth* depth : {&still.depths[0], &moved.depths[0], &moved.depths[7]}) {
    EXPECT_NEAR(world(*depth, 2, 46)[1], 1.23, 0.02);
    EXPECT_NEAR(world(*depth, 61, 46)[1], 1.23, 0.02);
    const auto middle = world(*depth, 32, 28);
    EXPECT_LT(std::abs(middle[0]), 0.9);
    EXPECT_LT(middle[1], 0.56);
  }
}

TEST(RgbdTestSrc, DepthSurvivesOtherElements) {
  const Recorded scaled =
      record("num-buffers=1 depth-noise=0",
             std::string(kLinear) +
                 " ! videoconvert ! videoscale ! queue ! video/x-raw,format=I420,"
                 "width=32,height=24");
  ASSERT_EQ(scaled.depths.size(), 1U) << scaled.line.first_error();
  EXPECT_EQ(scaled.depths[0].meta.width, 64U);
  EXPECT_EQ(scaled.depths[0].meters, record("num-buffers=1 depth-noise=0").depths[0].meters);
  const Recorded cropped = record("num-buffers=1",
                                  "video/x-raw,width=64,height=48 ! videoconvert ! "
                                  "video/x-raw,format=RGB ! videocrop left=8");
  ASSERT_EQ(cropped.line.frames.size(), 1U) << cropped.line.first_error();
  EXPECT_TRUE(cropped.depths.empty()) << "it shows a part of the scene only";
}

TEST(RgbdTestSrc, SeeksAndComesBack) {
  Pipeline pipeline("rgbdtestsrc is-live=false num-buffers=100 ! " + std::string(kLinear) +
                    " ! appsink name=out sync=false max-buffers=1");
  ASSERT_TRUE(pipeline.reaches(GST_STATE_PAUSED));
  ASSERT_TRUE(gst_element_seek_simple(pipeline.get(), GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                                      2 * GST_SECOND));
  pipeline.set(GST_STATE_PLAYING);
  GstSample* sample = pipeline.sample("out");
  ASSERT_NE(sample, nullptr);
  EXPECT_EQ(GST_BUFFER_PTS(gst_sample_get_buffer(sample)), 2 * GST_SECOND);
  EXPECT_EQ(GST_BUFFER_OFFSET(gst_sample_get_buffer(sample)), 60U);
  gst_sample_unref(sample);
}

TEST(RgbdTestSrc, PlaysLiveAndEnds) {
  Pipeline pipeline(
      "rgbdtestsrc num-buffers=5 samples=1 ! video/x-raw,width=32,height=24,framerate=10/1 ! "
      "fakesink sync=false");
  const GstClockTime start = gst_util_get_timestamp();
  pipeline.set(GST_STATE_PLAYING);
  EXPECT_TRUE(pipeline.ends());
  EXPECT_GE(gst_util_get_timestamp() - start, 350 * GST_MSECOND);
}

TEST(RgbdTestSrc, RefusesStillPictures) {
  const LineResult line = run_line("rgbdtestsrc ! video/x-raw,framerate=0/1 ! fakesink");
  EXPECT_NE(line.first_error().find("frame rate"), std::string::npos) << line.first_error();
}

}  // namespace
}  // namespace inverse::testing
