// SPDX-License-Identifier: LGPL-2.1-or-later
// Layers of limematerial: what carries them, what draws them, and who refuses them.
#include <algorithm>

#include "gst/inverse/inverse_material_meta.h"
#include "lime_fixture.hpp"
#include "tests/elements/layer_of.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kMaterial =
    "video/x-raw(" GST_CAPS_FEATURE_META_INVERSE_LAYERS "), layers=(string)material";

class MaterialLayers : public LimeElementTest {
 protected:
  static constexpr size_t kObject = 4 * (size_t{30} * kWidth + 60);
  /// What comes out of the last of six frames.
  static Buffer sixth(VideoHarness& harness) {
    for (int i = 0; i < 5; ++i) harness.process_buffer(scene(60, 30, 20));
    return harness.process_buffer(scene(60, 30, 20));
  }
};

}  // namespace

TEST_F(MaterialLayers, GoOutWhereTheyAreTaken) {
  VideoHarness harness(line(), caps(), kMaterial);
  const Buffer last = sixth(harness);
  GstBuffer* buffer = last.get();
  EXPECT_FALSE(has_pixels(buffer));
  ASSERT_NE(gst_buffer_get_material_meta(buffer), nullptr);
  EXPECT_TRUE(gst_buffer_get_material_meta(buffer)->found);
  const auto input = layer_of(buffer, GST_INVERSE_ROLE_INPUT);
  const auto diffuse = layer_of(buffer, GST_INVERSE_ROLE_DIFFUSE);
  const auto specular = layer_of(buffer, GST_INVERSE_ROLE_SPECULAR);
  ASSERT_EQ(input.size(), size_t{4} * kWidth * kHeight);
  ASSERT_EQ(diffuse.size(), input.size());
  ASSERT_EQ(specular.size(), input.size());
  EXPECT_TRUE(layer_of(buffer, GST_INVERSE_ROLE_INTRINSIC).empty());
  for (size_t i = 0; i < input.size(); ++i)
    ASSERT_NEAR(i % 4 == 3 ? input[i] : diffuse[i] + specular[i], input[i], 1e-6) << i;
  EXPECT_EQ(diffuse[kObject + 3], 1) << "mask";
  EXPECT_EQ(diffuse[3], 0);
  EXPECT_GT(specular[kObject], .01);
  EXPECT_GT(specular[kObject + 3], specular[kObject]) << "mirror image";
  EXPECT_EQ(specular[3], 0);
}

TEST_F(MaterialLayers, UneditedTheyAreComposedToTheInput) {
  for (const char* format : {"RGBA", "RGBA64_LE", "BGR"}) {
    const std::string video = VideoHarness::caps(format, kWidth, kHeight);
    VideoHarness harness(line() + " ! intrinsiccompose", video, video);
    std::vector<uint8_t> frame;
    for (unsigned i = 0; i < 6; ++i) {
      frame = random_frame(video, i);
      if (std::string(format) == "RGBA") {
        const auto object = scene(60, 30, 20);
        for (size_t k = 0; k < frame.size(); ++k)
          if (object[k] != 128) frame[k] = object[k];
      }
      ASSERT_EQ(largest_difference(visible(video, harness.process(frame)), visible(video, frame)),
                0)
          << format << " frame " << i;
    }
    EXPECT_TRUE(harness.errors().empty());
  }
}

TEST_F(MaterialLayers, AnEditShowsInThePicture) {
  VideoHarness lime(line(), caps(), kMaterial);
  GstBuffer* buffer = gst_buffer_make_writable(sixth(lime).release());
  const std::vector<float> none(layer_of(buffer, GST_INVERSE_ROLE_SPECULAR).size());
  EXPECT_TRUE(replace_layer(buffer, GST_INVERSE_ROLE_SPECULAR, none));
  const auto diffuse = layer_of(buffer, GST_INVERSE_ROLE_DIFFUSE);
  VideoHarness compose("intrinsiccompose", caps_out_of(lime.harness()), caps());
  ASSERT_EQ(gst_harness_push(compose.harness(), buffer), GST_FLOW_OK);
  const auto pixels = compose.pull();
  const double red = static_cast<double>(diffuse[kObject]);
  EXPECT_NEAR(pixels[kObject], 255 * srgb_code(red), 1) << "without highlights";
  EXPECT_EQ(pixels[0], 128);
}

TEST_F(MaterialLayers, ComposeShowsEachOfThem) {
  const auto at_object = [&](const std::string& elements) {
    VideoHarness harness(line("show=input") + elements, caps(), caps());
    const auto out = harness.process(scene(60, 30, 20), 6);
    EXPECT_TRUE(harness.errors().empty());
    return out.empty() ? std::vector<uint8_t>(4) : std::vector(&out[kObject], &out[kObject + 4]);
  };
  for (const char* show : {"diffuse", "specular", "mirror", "mask"}) {
    VideoHarness direct(line(std::string("show=") + show), caps(), caps());
    const auto out = direct.process(scene(60, 30, 20), 6);
    EXPECT_EQ(at_object(std::string(" ! intrinsiccompose show=") + show),
              std::vector(&out[kObject], &out[kObject + 4]))
        << show;
  }
  EXPECT_NEAR(at_object(" ! intrinsiccompose show=difference")[1], 128, 1);
}

TEST_F(MaterialLayers, SplitSendsThem) {
  const std::string source =
      "videotestsrc num-buffers=5 pattern=ball ! video/x-raw,width=96,height=64 ! ";
  for (const char* pad : {"diffuse", "specular", "mirror", "mask", "input"}) {
    const auto result = run_line(source + line() + " ! intrinsicsplit name=s s." + pad +
                                 " ! queue ! appsink name=out");
    EXPECT_TRUE(result.eos) << pad << ": " << result.first_error();
    EXPECT_EQ(result.frames.size(), 5u) << pad;
  }
  const auto refused =
      run_line(source + line() + " ! intrinsicsplit name=s s.reflectance ! fakesink").first_error();
  expect_contains(refused, "no reflectance");
  expect_contains(refused, "intrinsicdecomp");
  const auto direct = run_line(source + line() + " ! intrinsicsplit name=s s.direct ! fakesink");
  expect_contains(direct.first_error(), "globalintrinsic");
  EXPECT_EQ(std::count_if(direct.errors.begin(), direct.errors.end(),
                          [](const std::string& text) {
                            return text.find("no direct") != std::string::npos;
                          }),
            1)
      << "reported once";
  const auto other =
      run_line(source + "intrinsicdecomp ! intrinsicsplit name=s s.mirror ! fakesink")
          .first_error();
  expect_contains(other, "no mirror");
  expect_contains(other, "limematerial");
}

TEST_F(MaterialLayers, EditorsOfReflectanceRefuseThem) {
  const std::string source =
      "videotestsrc num-buffers=3 ! video/x-raw,width=96,height=64 ! " + line() + " ! ";
  for (const char* editor : {"intrinsicrecolor", "intrinsickey", "intrinsicdespill",
                             "intrinsictone", "intrinsicstylize", "intrinsicrelight"}) {
    const auto error = run_line(source + editor + " ! intrinsiccompose ! fakesink").first_error();
    expect_contains(error, "works on layers");
    const auto forced =
        run_line(source + kMaterial + " ! " + editor + " ! intrinsiccompose ! fakesink");
    EXPECT_FALSE(forced.eos) << editor;
    EXPECT_FALSE(forced.errors.empty()) << editor;
  }
  const auto show = run_line(source + "intrinsiccompose show=reflectance ! fakesink").first_error();
  expect_contains(show, "no reflectance");
  const auto direct = run_line(source + "intrinsiccompose show=direct ! fakesink").first_error();
  expect_contains(direct, "do not separate direct light");
}

}  // namespace inverse::testing
