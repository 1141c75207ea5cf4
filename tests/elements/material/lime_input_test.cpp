// SPDX-License-Identifier: LGPL-2.1-or-later
// limematerial with input and networks of every bad kind.
#include <algorithm>
#include <limits>

#include "gst/material/meta/inverse_material_meta.h"
#include "kernels/network/graph_file.hpp"
#include "lime_fixture.hpp"
#include "tests/expect_error.hpp"

namespace inverse::testing {
namespace {

class LimeInput : public LimeElementTest {
 protected:
  static GstElement* lime(VideoHarness& harness) { return harness.find("limematerial"); }
  static bool found(VideoHarness& harness) { return stat<bool>(lime(harness), "found"); }
};

/// Both scenes in one: the second's object over the first's.
std::vector<uint8_t> both(std::vector<uint8_t> first, const std::vector<uint8_t>& second) {
  for (size_t i = 0; i < first.size(); i += 4)
    if (second[i] == 230) std::copy_n(&second[i], 4, &first[i]);
  return first;
}

}  // namespace

TEST_F(LimeInput, TheLargestOfSeveralObjectsCounts) {
  VideoHarness harness(line("show=mask"), caps(), caps());
  const auto frame = both(both(scene(14, 14, 9), scene(66, 34, 20)), scene(14, 50, 8));
  for (int i = 0; i < 8; ++i) ASSERT_FALSE(harness.process(frame).empty());
  ASSERT_TRUE(found(harness));
  EXPECT_NEAR(stat<double>(lime(harness), "left"), 46, 3);
  EXPECT_NEAR(stat<double>(lime(harness), "right"), 86, 3);
}

TEST_F(LimeInput, AnObjectThatTheFrameCutsIsFound) {
  for (const auto& [x, y] : {std::pair{0, 32}, {95, 10}, {48, 63}, {0, 0}}) {
    VideoHarness harness(line("show=preview estimate-light=true"), caps(), caps());
    for (int i = 0; i < 8; ++i) ASSERT_FALSE(harness.process(scene(x, y, 25)).empty());
    EXPECT_TRUE(found(harness)) << x << ", " << y;
    EXPECT_GT(stat<guint64>(lime(harness), "light-views"), 0u);
    EXPECT_GE(stat<double>(lime(harness), "left"), 0);
    EXPECT_LE(stat<double>(lime(harness), "right"), kWidth);
    EXPECT_TRUE(harness.errors().empty());
  }
}

TEST_F(LimeInput, PixelsThatAreNotSquareAreWarnedOfOnce) {
  const auto shape = [](const char* ratio) {
    return VideoHarness::caps("RGBA", kWidth, kHeight, std::string("pixel-aspect-ratio=") + ratio);
  };
  VideoHarness harness(line(), shape("16/15"));
  for (int i = 0; i < 3; ++i) ASSERT_FALSE(harness.process(scene(48, 32, 20)).empty());
  const auto warnings = harness.warnings();
  ASSERT_EQ(warnings.size(), 1u);
  expect_contains(warnings.front(), "16:15");
  harness.set_src_caps(shape("1/1"));
  ASSERT_FALSE(harness.process(scene(48, 32, 20)).empty());
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_F(LimeInput, FramesOfOneValueGiveFrames) {
  for (const char* show : {"diffuse", "mosaic", "preview"})
    for (const uint8_t value : {0, 255}) {
      VideoHarness harness(line(std::string("estimate-light=true show=") + show), caps(), caps());
      for (int i = 0; i < 5; ++i)
        ASSERT_FALSE(harness.process(flat_frame(caps(), value)).empty()) << show;
      EXPECT_FALSE(found(harness));
      EXPECT_TRUE(harness.errors().empty());
    }
}

TEST_F(LimeInput, ASaturatedObjectHasAMaterialAndSoundLight) {
  VideoHarness harness(line("estimate-light=true adaptive=false"), caps(), caps());
  auto frame = scene(50, 32, 24);
  for (size_t i = 0; i < frame.size(); i += 4)
    if (frame[i] == 230) frame[i] = 255;
  for (int i = 0; i < 8; ++i) ASSERT_FALSE(harness.process(frame).empty());
  EXPECT_TRUE(found(harness));
  ASSERT_EQ(harness.push(frame), GST_FLOW_OK);
  GstBuffer* out = gst_harness_pull(harness.harness());
  const GstMaterialMeta* meta = gst_buffer_get_material_meta(out);
  EXPECT_GT(meta->averaged, 0u);
  ASSERT_NE(meta->environment, nullptr);
  gsize size = 0;
  const auto* light = static_cast<const float*>(g_bytes_get_data(meta->environment, &size));
  ASSERT_GT(size, 0u);
  for (size_t i = 0; i < size / sizeof(float); ++i)
    ASSERT_TRUE(std::isfinite(light[i]) && light[i] >= 0);
  gst_buffer_unref(out);
}

TEST_F(LimeInput, NoiseGivesFrames) {
  for (const char* format : {"RGBA", "NV12", "GRAY16_LE", "P010_10LE"})
    for (const int size : {16, 96}) {
      const std::string video = VideoHarness::caps(format, size, size);
      VideoHarness harness(line("estimate-light=true show=preview"), video, video);
      for (unsigned i = 0; i < 5; ++i)
        ASSERT_FALSE(harness.process(random_frame(video, i)).empty()) << format;
      EXPECT_TRUE(harness.errors().empty());
    }
}

TEST_F(LimeInput, SixteenPixelsAreEnough) {
  for (const char* show : {"mask", "preview", "mosaic"}) {
    VideoHarness harness(line(std::string("show=") + show), caps(16, 16), caps(16, 16));
    for (int i = 0; i < 8; ++i) ASSERT_FALSE(harness.process(scene(8, 8, 6, 16, 16)).empty());
    EXPECT_TRUE(found(harness)) << show;
  }
}

TEST_F(LimeInput, EightThousandPixelsAreShownOrRefusedByName) {
  const auto result = run_line(
      "videotestsrc num-buffers=2 pattern=ball ! video/x-raw,format=NV12,width=7680,height=4320 "
      "! " +
          line("show=input") + " ! fakesink",
      300);
  if (!result.eos) {
    expect_contains(result.first_error(), "maxStorageBufferRange");
  }
  EXPECT_NE(result.eos, !result.errors.empty());
}

TEST_F(LimeInput, NewCapsMidStreamStartAfresh) {
  VideoHarness harness(line("show=preview estimate-light=true"), caps());
  for (const auto& [width, height] :
       {std::pair{96, 64}, {200, 120}, {16, 16}, {64, 96}, {97, 63}, {96, 64}}) {
    harness.set_src_caps(caps(width, height));
    const int radius = std::min(width, height) * 2 / 5;
    for (int i = 0; i < 6; ++i)
      ASSERT_FALSE(harness.process(scene(width / 2, height / 2, radius, width, height)).empty());
    EXPECT_TRUE(found(harness)) << width << "x" << height;
    EXPECT_GT(stat<guint64>(lime(harness), "light-views"), 0u);
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(LimeInput, NetworksOfNoNumbersGiveNoNumbersOut) {
  const auto make_huge = [](network::Graph& graph) {
    for (size_t i = 0; i < graph.weights.size(); ++i) graph.weights[i] = i % 2 ? 3e38F : -3e38F;
  };
  const auto spoil = [&](const char* name, LimeModels& m) {
    network::Graph& graph = std::string(name) == "segmentation" ? m.segmentation
                            : std::string(name) == "specular"   ? m.specular
                            : std::string(name) == "mirror"     ? m.mirror
                            : std::string(name) == "albedo"     ? m.albedo
                                                                : m.exponent;
    make_huge(graph);
    return network::to_file(graph);
  };
  for (const char* name : {"segmentation", "specular", "mirror", "albedo", "exponent"}) {
    const HandMadeLime spoilt;
    LimeModels models = HandMadeLime::models();
    spoilt.write(name, spoil(name, models));
    VideoHarness harness("limematerial show=preview estimate-light=true models=" + spoilt.folder(),
                         caps(), caps());
    for (int i = 0; i < 8; ++i) ASSERT_FALSE(harness.process(scene(50, 30, 20)).empty()) << name;
    GstElement* element = harness.find("limematerial");
    if (std::string(name) != "segmentation") {
      EXPECT_TRUE(found(harness)) << name;
    }
    for (const char* number : {"specular-albedo", "shininess"})
      EXPECT_TRUE(std::isfinite(property<gfloat>(element, number))) << name;
    ASSERT_EQ(harness.push(scene(50, 30, 20)), GST_FLOW_OK);
    GstBuffer* out = gst_harness_pull(harness.harness());
    const GstMaterialMeta* meta = gst_buffer_get_material_meta(out);
    for (const float v : meta->diffuse) EXPECT_TRUE(std::isfinite(v)) << name;
    if (meta->environment) {
      gsize size = 0;
      const auto* light = static_cast<const float*>(g_bytes_get_data(meta->environment, &size));
      for (size_t i = 0; i < size / sizeof(float); ++i)
        ASSERT_TRUE(std::isfinite(light[i])) << name;
    }
    gst_buffer_unref(out);
    EXPECT_TRUE(harness.errors().empty()) << name;
  }
}

TEST_F(LimeInput, SpoiltNetworkFilesAreOneErrorThatNamesThem) {
  const auto error = [](const HandMadeLime& models) {
    const auto result = run_line(
        "videotestsrc num-buffers=2 ! limematerial models=" + models.folder() + " ! fakesink");
    EXPECT_FALSE(result.eos);
    return result.first_error();
  };
  HandMadeLime cut, wrong, empty, nan;
  auto bytes = network::to_file(HandMadeLime::models().mirror);
  bytes.resize(bytes.size() / 2);
  cut.write("mirror", bytes);
  expect_contains(error(cut), "mirror.net");
  wrong.write("albedo", network::to_file(HandMadeLime::models().mirror));
  expect_contains(error(wrong), "albedo.net");
  LimeModels models = HandMadeLime::models();
  models.specular.weights[0] = std::numeric_limits<float>::quiet_NaN();
  nan.write("specular", network::to_file(models.specular));
  expect_contains(error(nan), "specular.net");
  empty.write("exponent", {});
  expect_contains(error(empty), "exponent.net");
}

// More pixels than a line of workgroups has.
TEST_F(LimeInput, LargeFramesHaveLayers) {
  constexpr int kLargeWidth = 2592, kLargeHeight = 1944;
  VideoHarness harness(line("show=mask"), caps(kLargeWidth, kLargeHeight));
  for (int i = 0; i < 3; ++i)
    ASSERT_FALSE(harness.process(scene(1300, 900, 700, kLargeWidth, kLargeHeight)).empty());
  EXPECT_TRUE(found(harness));
  EXPECT_TRUE(harness.errors().empty());
}

}  // namespace inverse::testing
