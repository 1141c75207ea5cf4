// SPDX-License-Identifier: LGPL-2.1-or-later
// limematerial with input and networks of every bad kind.
#include <algorithm>
#include <limits>

#include "gst/inverse/inverse_material_meta.h"
#include "kernels/network/graph_file.hpp"
#include "lime_fixture.hpp"

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
  harness.process(frame, 8);
  ASSERT_TRUE(found(harness));
  EXPECT_NEAR(stat<double>(lime(harness), "left"), 46, 3);
  EXPECT_NEAR(stat<double>(lime(harness), "right"), 86, 3);
}

TEST_F(LimeInput, AnObjectThatTheFrameCutsIsFound) {
  for (const auto& [x, y] : {std::pair{0, 32}, {95, 10}, {48, 63}, {0, 0}}) {
    VideoHarness harness(line("show=preview estimate-light=true"), caps(), caps());
    harness.process(scene(x, y, 25), 8);
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
  harness.process(scene(48, 32, 20), 3);
  expect_one(harness.warnings(), "16:15");
  harness.set_src_caps(shape("1/1"));
  ASSERT_FALSE(harness.process(scene(48, 32, 20)).empty());
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_F(LimeInput, FramesOfOneValueGiveFrames) {
  for (const char* show : {"diffuse", "mosaic", "preview"})
    for (const uint8_t value : {0, 255}) {
      VideoHarness harness(line(std::string("estimate-light=true show=") + show), caps(), caps());
      harness.process(flat_frame(caps(), value), 5);
      EXPECT_FALSE(found(harness));
      EXPECT_TRUE(harness.errors().empty());
    }
}

TEST_F(LimeInput, ASaturatedObjectHasAMaterialAndSoundLight) {
  VideoHarness harness(line("estimate-light=true adaptive=false"), caps(), caps());
  auto frame = scene(50, 32, 24);
  for (size_t i = 0; i < frame.size(); i += 4)
    if (frame[i] == 230) frame[i] = 255;
  harness.process(frame, 8);
  EXPECT_TRUE(found(harness));
  const Buffer out = harness.process_buffer(frame);
  const GstMaterialMeta* meta = gst_buffer_get_material_meta(out.get());
  EXPECT_GT(meta->averaged, 0u);
  const auto light = floats_of(meta->environment);
  ASSERT_FALSE(light.empty());
  for (const float value : light) ASSERT_TRUE(std::isfinite(value) && value >= 0);
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
    harness.process(scene(8, 8, 6, 16, 16), 8);
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
    harness.process(scene(width / 2, height / 2, radius, width, height), 6);
    EXPECT_TRUE(found(harness)) << width << "x" << height;
    EXPECT_GT(stat<guint64>(lime(harness), "light-views"), 0u);
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(LimeInput, NetworksOfNoNumbersGiveNoNumbersOut) {
  for (const auto& [name, model] : {std::pair{"segmentation", &LimeModels::segmentation},
                                    {"specular", &LimeModels::specular},
                                    {"mirror", &LimeModels::mirror},
                                    {"albedo", &LimeModels::albedo},
                                    {"exponent", &LimeModels::exponent}}) {
    const HandMadeLime spoilt;
    network::Graph graph = HandMadeLime::models().*model;
    for (size_t i = 0; i < graph.weights.size(); ++i) graph.weights[i] = i % 2 ? 3e38F : -3e38F;
    spoilt.write(name, network::to_file(graph));
    VideoHarness harness("limematerial show=preview estimate-light=true models=" + spoilt.folder(),
                         caps(), caps());
    harness.process(scene(50, 30, 20), 8);
    GstElement* element = harness.find("limematerial");
    if (std::string(name) != "segmentation") {
      EXPECT_TRUE(found(harness)) << name;
    }
    for (const char* number : {"specular-albedo", "shininess"})
      EXPECT_TRUE(std::isfinite(property<gfloat>(element, number))) << name;
    const Buffer out = harness.process_buffer(scene(50, 30, 20));
    const GstMaterialMeta* meta = gst_buffer_get_material_meta(out.get());
    for (const float v : meta->diffuse) EXPECT_TRUE(std::isfinite(v)) << name;
    for (const float v : floats_of(meta->environment)) ASSERT_TRUE(std::isfinite(v)) << name;
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
  harness.process(scene(1300, 900, 700, kLargeWidth, kLargeHeight), 3);
  EXPECT_TRUE(found(harness));
  EXPECT_TRUE(harness.errors().empty());
}

}  // namespace inverse::testing
