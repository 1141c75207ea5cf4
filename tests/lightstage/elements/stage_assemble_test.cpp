// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync: pairs of gradients.
#include "stage_fixture.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kGradients =
    "video/x-raw(" GST_CAPS_FEATURE_META_INVERSE_LAYERS "), layers=(string)gradients";

class StagePairs : public StageSync {
 protected:
  void SetUp() override {
    StageSync::SetUp();
    use_performance();
    gst_util_set_object_arg(G_OBJECT(element_), "assemble", "pairs");
  }
  std::vector<uint8_t> picture(int64_t n, double shift = 0) {
    return BallOnStage(program_, kWidth, kHeight).draw(n, shift);
  }
};

/// Columns from…to of RGBA frames.
std::vector<uint8_t> columns(const std::vector<uint8_t>& frame, int width, int from, int to) {
  std::vector<uint8_t> part;
  for (size_t row = 0; row < frame.size() / 4 / static_cast<size_t>(width); ++row) {
    const auto begin = frame.begin() + (static_cast<ptrdiff_t>(row) * width + from) * 4;
    part.insert(part.end(), begin, begin + (to - from) * 4);
  }
  return part;
}

TEST_F(StagePairs, ThirtyPairsOfSixtyFramesSideBySide) {
  start();
  push_all(-10, 63);
  const auto pairs = pull(30);
  for (size_t i = 0; i < pairs.size(); ++i) {
    const auto n = static_cast<int64_t>(3 + 2 * i);
    EXPECT_EQ(pairs[i].trigger, n);
    EXPECT_EQ(pairs[i].kind, GST_LIGHT_STAGE_GRADIENTS);
    EXPECT_EQ(columns(pairs[i].bytes, 2 * kWidth, 0, kWidth), picture(n));
    EXPECT_EQ(columns(pairs[i].bytes, 2 * kWidth, kWidth, 2 * kWidth), picture(n + 1));
    EXPECT_EQ(pairs[i].pts, static_cast<GstClockTime>((n + 100) * GST_SECOND / 60));
    EXPECT_NEAR(static_cast<double>(pairs[i].duration), GST_SECOND / 30.0, 2);
  }
  EXPECT_EQ(count("pairs"), 30u);
  const GstVideoInfo info = info_of(caps_out_of(camera()));
  EXPECT_EQ(GST_VIDEO_INFO_WIDTH(&info), 2 * kWidth);
  EXPECT_EQ(GST_VIDEO_INFO_FPS_N(&info), 30 * GST_VIDEO_INFO_FPS_D(&info));
  gst_harness_set_upstream_latency(camera(), 20 * GST_MSECOND);
  EXPECT_NEAR(static_cast<double>(gst_harness_query_latency(camera())),
              static_cast<double>(20 * GST_MSECOND + GST_SECOND / 60), 2);
}

TEST_F(StagePairs, LayersWhereTheNextElementTakesThem) {
  camera(0, kGradients);
  start();
  push_all(-10, 13);
  for (int i = 0; i < 5; ++i) {
    const Buffer pair(gst_harness_pull(camera()));
    ASSERT_NE(pair, nullptr);
    EXPECT_FALSE(has_pixels(pair.get()));
    GstInverseLayersMeta* meta = gst_buffer_get_inverse_layers_meta(pair.get());
    ASSERT_NE(meta, nullptr);
    EXPECT_EQ(meta->width, static_cast<guint>(kWidth));
    for (const int which : {0, 1}) {
      const auto light =
          layer_of(pair.get(), which ? GST_INVERSE_ROLE_GRADIENT_B : GST_INVERSE_ROLE_GRADIENT_A);
      const auto codes = picture(3 + 2 * i + which);
      ASSERT_EQ(light.size(), codes.size());
      for (size_t k = 0; k < codes.size(); ++k) {
        const double code = codes[k] / 255.0;
        const double linear = k % 4 == 3 ? code : srgb_light(code);
        ASSERT_NEAR(static_cast<double>(light[k]), linear, 1e-4);
      }
    }
  }
}

TEST_F(StagePairs, FramesWithoutTheOtherHalfAreCounted) {
  start();
  push_all(-10, 20);  // without a B
  push_all(21, 31);   // and an A
  push_all(32, 43);
  EXPECT_EQ(pull(18).back().trigger, 41);
  EXPECT_EQ(count("unpaired"), 2u);
}

TEST_F(StagePairs, ADoubledFrameCostsNoPairAlsoWhereUnlabeledOnesMayPass) {
  g_object_set(element_, "tuning", "drop-unlabeled=false", nullptr);
  start();
  for (int64_t n = -10; n < 43; ++n)
    for (int copies = n == 21 || n == 30 ? 2 : 1; copies; --copies) ASSERT_EQ(push(n), GST_FLOW_OK);
  EXPECT_EQ(pull(20).back().trigger, 41);
  EXPECT_EQ(count("duplicates"), 2u);
  EXPECT_EQ(count("unpaired"), 0u);
}

TEST_F(StagePairs, SizesThatChangeWithinAPairMakeNone) {
  start();
  push_all(-10, 14);
  const BallOnStage small(program_, 32, 20);
  start(0, caps(32, 20));
  push_all(small, 14, 24);
  const auto pairs = pull(9);  // 3 … 11, 15 … 21
  EXPECT_EQ(pairs.back().trigger, 21);
  EXPECT_EQ(pairs.back().bytes.size(), 64u * 20 * 4);
  EXPECT_EQ(count("unpaired"), 2u);  // 13 and 14
  EXPECT_TRUE(errors().empty());
}

TEST_F(StagePairs, EveryFormatCanBeJoinedAtOddSizes) {
  LightProgram unmarked = program_;
  unmarked.marker = LightProgram::Marker::none;
  use(unmarked);
  camera();
  int64_t n = 0;
  for (const char* format :
       {"I420", "NV12", "GRAY8", "P010_10LE", "UYVY", "YUY2", "RGB", "RGBA64_LE", "I420_10LE"}) {
    for (const int width : {13, 16}) {
      const std::string odd = "video/x-raw, format=" + std::string(format) +
                              ", width=" + std::to_string(width) + ", height=9, framerate=60/1";
      start(0, odd);
      const std::vector<uint8_t> halves[] = {random_frame(odd, 1), random_frame(odd, 2)};
      for (const auto& half : halves) ASSERT_EQ(push(half, static_cast<double>(n++)), GST_FLOW_OK);
      const auto pairs = pull(1);
      const GstVideoInfo joined = info_of(caps_out_of(camera())), one = info_of(odd);
      ASSERT_EQ(pairs[0].bytes.size(), joined.size) << format;
      EXPECT_EQ(GST_VIDEO_INFO_WIDTH(&joined), 2 * width);
      // The first plane has whole pixels, unless two share a byte's neighbors.
      const bool shared = GST_VIDEO_INFO_N_PLANES(&one) == 1 &&
                          GST_VIDEO_FORMAT_INFO_IS_YUV(one.finfo) && width % 2;
      if (shared) continue;
      const size_t bytes = static_cast<size_t>(width * GST_VIDEO_INFO_COMP_PSTRIDE(&one, 0));
      for (size_t row = 0; row < 9; ++row)
        for (size_t which = 0; which < 2; ++which) {
          const auto* to =
              &pairs[0].bytes[row * static_cast<size_t>(joined.stride[0]) + which * bytes];
          const auto* from = &halves[which][row * static_cast<size_t>(one.stride[0])];
          size_t off = 0;
          for (size_t i = 0; i < bytes; ++i) off += to[i] != from[i] ? 1 : 0;
          // Samples of ten bits have six that say nothing.
          const bool padded = GST_VIDEO_INFO_COMP_DEPTH(&one, 0) == 10;
          EXPECT_TRUE(off == 0 || padded) << format << " " << width << " row " << row;
        }
    }
  }
  EXPECT_EQ(count("pairs"), 18u);
  EXPECT_TRUE(errors().empty());
}

TEST_F(StagePairs, WhatFollowsMayTakeNeither) {
  camera(0, "video/x-raw, format=RGBA, width=48");
  start();
  for (int64_t n = -10; n < 20; ++n)
    if (push(n) != GST_FLOW_OK) break;
  for (int i = 0; i < 500 && push(20) == GST_FLOW_OK; ++i) g_usleep(10000);
  expect_one(errors(), "double width");
}

TEST_F(StagePairs, AlignedPairsOfAMovingSubjectFitBetter) {
  constexpr int kWide = 160, kHigh = 120;
  double errors[2] = {};
  for (const int aligned : {0, 1}) {
    if (aligned) {
      TearDown();
      cameras_.clear();
      bus_ = gst_bus_new();
      SetUp();
      gst_util_set_object_arg(G_OBJECT(element_), "align", "flow");
    }
    const BallOnStage ball(program_, kWide, kHigh);
    start(0, caps(kWide, kHigh));
    const auto place = [](int64_t n) { return 1.7 * static_cast<double>(n) - 20; };
    for (int64_t n = -5; n < 23; ++n)
      ASSERT_EQ(push(ball.draw(n, place(n)), static_cast<double>(n)), GST_FLOW_OK);
    const auto pairs = pull(10);
    for (size_t i = 1; i < pairs.size(); ++i) {
      const int64_t n = pairs[i].trigger;
      // B as it would have been at A's time.
      const auto truth = ball.draw(n + 1, place(n));
      errors[aligned] += l1(columns(pairs[i].bytes, 2 * kWide, kWide, 2 * kWide), truth) / 9;
    }
    EXPECT_EQ(count("unaligned"), aligned ? 1u : 0u);
  }
  RecordProperty("l1_as_seen", std::to_string(errors[0]));
  RecordProperty("l1_aligned", std::to_string(errors[1]));
  printf("B against what it would have been at A's time, l1 in codes: %.3f as seen, %.3f aligned\n",
         errors[0], errors[1]);
  EXPECT_LT(errors[1], 0.4 * errors[0]);
}

}  // namespace
}  // namespace inverse::testing
