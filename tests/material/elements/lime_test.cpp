// SPDX-License-Identifier: LGPL-2.1-or-later
// limematerial, with networks whose results are known.
#include <gst/base/gstbasetransform.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "gst/inverse/inverse_material_meta.h"
#include "lime_fixture.hpp"
#include "tests/elements/draw.hpp"
#include "tests/has_networks.hpp"
#include "tests/srgb.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {

TEST_F(LimeElementTest, ReportsTheMaterialInPropertiesStatsAndMeta) {
  VideoHarness harness(line(), caps(), caps());
  GstElement* lime = harness.find("limematerial");
  harness.process(scene(60, 30, 20), 8);
  const auto color = property<guint>(lime, "diffuse-albedo");
  const auto code = [](double v) { return std::lround(255 * srgb_code(v)); };
  EXPECT_EQ(color, 0xff000000u | static_cast<guint>(code(.2) << 16 | code(.5) << 8 | code(.7)));
  EXPECT_NEAR(std::log2(property<gfloat>(lime, "shininess")), 1 + 9 * 5.5 / 8, .5);
  EXPECT_GT(property<gfloat>(lime, "specular-albedo"), .2);
  EXPECT_EQ(stat<guint>(lime, "bin"), 5u);
  EXPECT_NEAR(stat<double>(lime, "diffuse-green"), .5, 1e-3);

  Buffer out = harness.process_buffer(scene(60, 30, 20));
  GstMaterialMeta* meta = gst_buffer_get_material_meta(out.get());
  ASSERT_NE(meta, nullptr);
  EXPECT_TRUE(meta->found);
  EXPECT_NEAR(meta->diffuse[2], .7, 1e-3);
  EXPECT_NEAR((meta->left + meta->right) / 2, 60, 3);
  Buffer copy(gst_buffer_copy(out.get()));
  ASSERT_NE(gst_buffer_get_material_meta(copy.get()), nullptr);
  EXPECT_EQ(gst_buffer_get_material_meta(copy.get())->averaged, meta->averaged);

  bool freed = false;
  const auto free_light = [](gpointer flag) { *static_cast<bool*>(flag) = true; };
  GBytes* light = g_bytes_new_with_free_func("light", 5, free_light, &freed);
  g_clear_pointer(&meta->environment, g_bytes_unref);
  meta->environment = g_bytes_ref(light);
  copy.reset(gst_buffer_copy(out.get()));
  out.reset();
  EXPECT_EQ(gst_buffer_get_material_meta(copy.get())->environment, light) << "shared by copies";
  copy.reset();
  EXPECT_FALSE(freed);
  g_bytes_unref(light);
  EXPECT_TRUE(freed) << "no buffer references it";
}

TEST_F(LimeElementTest, ReportsThatAnObjectComesAndGoes) {
  VideoHarness harness(line(), caps(), caps());
  const auto changes = [&] {
    std::vector<bool> found;
    for (const Structure& message : element_messages(harness.bus(), "material"))
      found.push_back(field<bool>(message.get(), "found").value());
    return found;
  };
  for (int i = 0; i < 4; ++i) harness.process(scene(0, 0, 0));
  EXPECT_TRUE(changes().empty());
  for (int i = 0; i < 12; ++i) harness.process(scene(40, 30, 18));
  const auto came = changes();
  ASSERT_FALSE(came.empty());
  EXPECT_TRUE(came.front());
  EXPECT_LE(came.size(), 4u) << "not with every frame";
  for (int i = 0; i < 8; ++i) harness.process(scene(0, 0, 0));
  EXPECT_EQ(changes(), std::vector<bool>{false});
  EXPECT_EQ(property<guint>(harness.find("limematerial"), "diffuse-albedo"), 0u);
}

TEST_F(LimeElementTest, EveryShowHasAPicture) {
  std::map<std::string, std::vector<uint8_t>> shown;
  for (const char* show : {"input", "mask", "specular", "diffuse", "mirror", "mosaic"}) {
    VideoHarness harness(line(std::string("show=") + show), caps(), caps());
    const auto out = harness.process(scene(60, 30, 20), 6);
    ASSERT_EQ(out.size(), scene(0, 0, 0).size()) << show;
    const uint8_t* object = &out[4 * (30 * kWidth + 60)];
    if (!strcmp(show, "input")) {
      EXPECT_EQ(out, scene(60, 30, 20)) << "the same bits";
    }
    shown[show] = out;
    if (!strcmp(show, "mask")) {
      EXPECT_EQ(object[0], 255);
      EXPECT_EQ(out[0], 0);
    }
    if (!strcmp(show, "specular") || !strcmp(show, "mirror")) {
      EXPECT_GT(object[0], 20) << show;
      EXPECT_EQ(out[0], 0) << show;
    }
    if (!strcmp(show, "diffuse")) {
      EXPECT_LT(object[0], 230);
      EXPECT_NEAR(out[0], 128, 1);
    }
  }
  // The mosaic has them at half size: each one's middle of the disc.
  const auto pixel = [&](const char* show, int x, int y) {
    return &shown[show][4 * (static_cast<size_t>(y) * kWidth + static_cast<size_t>(x))];
  };
  const char* quarters[] = {"input", "diffuse", "specular", "mirror"};
  for (int i = 0; i < 4; ++i) {
    const uint8_t *whole = pixel(quarters[i], 60, 30),
                  *half = pixel("mosaic", kWidth / 2 * (i % 2) + 30, kHeight / 2 * (i / 2) + 15);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(half[c], whole[c], 2) << quarters[i];
  }
  EXPECT_GT(std::abs(pixel("specular", 60, 30)[0] - pixel("mirror", 60, 30)[0]), 4)
      << "or it shows nothing";
}

TEST_F(LimeElementTest, SkipsWorkForAnUnchangedObject) {
  VideoHarness harness(line("tuning=estimate-interval=6"), caps(), caps());
  GstElement* lime = harness.find("limematerial");
  for (int i = 0; i < 30; ++i) harness.process(scene(60, 30, 20));
  const auto before = stat<guint64>(lime, "estimates");
  for (int i = 0; i < 24; ++i) harness.process(scene(60, 30, 20));
  EXPECT_EQ(stat<guint64>(lime, "estimates"), before + 4);
  g_object_set(lime, "adaptive", FALSE, nullptr);
  for (int i = 0; i < 5; ++i) harness.process(scene(60, 30, 20));
  EXPECT_EQ(stat<guint64>(lime, "estimates"), before + 9);
}

TEST_F(LimeElementTest, AnUnchangedPictureIsNotDrawnAgain) {
  for (const char* show : {"input", "diffuse", "mosaic", "preview"}) {
    VideoHarness harness(line(std::string("tuning=estimate-interval=1000 show=") + show), caps(),
                         caps());
    GstElement* lime = harness.find("limematerial");
    const auto kept = [lime] { return stat<bool>(lime, "reused"); };
    auto out = harness.process(scene(60, 30, 20), 40);
    EXPECT_TRUE(kept()) << show;
    EXPECT_EQ(harness.process(scene(60, 30, 20)), out) << show;
    EXPECT_NE(harness.process(scene(62, 30, 20)), out) << show;
    EXPECT_FALSE(kept()) << show;
    out = harness.process(scene(60, 30, 20), 4);
    g_object_set(lime, "adaptive", FALSE, nullptr);
    EXPECT_EQ(harness.process(scene(60, 30, 20)), out) << show << ": the same, drawn anew";
    EXPECT_FALSE(kept()) << show;
  }
}

TEST_F(LimeElementTest, LayersOfAnUnchangedPictureAreReused) {
  VideoHarness harness(line("tuning=estimate-interval=1000") + " ! intrinsiccompose show=specular",
                       caps(), caps());
  const auto out = harness.process(scene(60, 30, 20), 40);
  EXPECT_GT(out[4 * (30 * kWidth + 60)], 20) << "there are highlights";
  EXPECT_TRUE(stat<bool>(harness.find("limematerial"), "reused"));
  g_object_set(harness.find("limematerial"), "adaptive", FALSE, nullptr);
  EXPECT_EQ(harness.process(scene(60, 30, 20)), out);
}

TEST_F(LimeElementTest, AnUnchangedPictureIsDrawnAgainForAnotherView) {
  VideoHarness harness(line("tuning=estimate-interval=1000 show=mask"), caps(), caps());
  GstElement* lime = harness.find("limematerial");
  const auto shown = [&](const char* property, const char* value) {
    gst_util_set_object_arg(G_OBJECT(lime), property, value);
    return harness.process(scene(60, 30, 20));
  };
  for (int i = 0; i < 40; ++i) harness.process(scene(60, 30, 20));
  const auto mask = shown("show", "mask"), diffuse = shown("show", "diffuse"),
             preview = shown("show", "preview");
  EXPECT_NE(mask, diffuse);
  EXPECT_NE(diffuse, preview);
  EXPECT_NE(shown("preview-size", "0.9"), preview);
  EXPECT_EQ(shown("show", "mask"), mask);
  harness.flush();
  EXPECT_NE(harness.process(scene(60, 30, 20)), mask) << "nothing is known of it any more";
}

TEST_F(LimeElementTest, APreviewIsDrawnAgainAfterItsLightIsDiscarded) {
  VideoHarness harness(line("tuning=estimate-interval=1000 show=preview"), caps(), caps());
  GstElement* lime = harness.find("limematerial");
  const auto lit = harness.process(scene(60, 30, 20), 40);
  EXPECT_TRUE(stat<bool>(lime, "reused"));
  EXPECT_GT(stat<guint64>(lime, "light-views"), 0u);
  gst_util_set_object_arg(G_OBJECT(lime), "normals", "none");
  EXPECT_NE(harness.process(scene(60, 30, 20)), lit) << "in a studio's light, as none is known";
}

TEST_F(LimeElementTest, TracksTheObjectAcrossAChangeOfRate) {
  const std::string caps = "video/x-raw,format=RGBA,width=96,height=64,framerate=";
  VideoHarness harness(line("adaptive=false"), caps + "25/1");
  GstElement* lime = harness.find("limematerial");
  for (int i = 0; i < 12; ++i) {
    if (i >= 6) harness.set_src_caps(caps + std::to_string(24 - i) + "/1");
    ASSERT_FALSE(harness.process(scene(60, 30, 20)).empty());
  }
  EXPECT_TRUE(stat<bool>(lime, "found"));
  EXPECT_GE(stat<guint64>(lime, "estimates"), 11u);
}

TEST_F(LimeElementTest, SurvivesFlushesAndNewCaps) {
  VideoHarness harness(line(), caps());
  GstElement* lime = harness.find("limematerial");
  harness.process(scene(60, 30, 20), 5);
  harness.flush();
  ASSERT_FALSE(harness.process(scene(0, 0, 0)).empty());
  EXPECT_FALSE(stat<bool>(lime, "found"));
  for (const auto& [width, height] : {std::pair{16, 16}, {1, 1}, {200, 120}, {33, 7}}) {
    harness.set_src_caps(caps(width, height));
    harness.process(scene(width / 2, height / 2, height / 3, width, height), 4);
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(LimeElementTest, ASecondRunIsAsTheFirst) {
  const TemporaryFolder folder;
  const std::string light = folder / "light.hdr";
  const auto runs = run_line_again(
      "videotestsrc num-buffers=8 pattern=solid-color foreground-color=0xffe66464 ! "
      "video/x-raw,format=RGBA,width=96,height=64 ! " +
          line("show=specular save-environment-location=" + light) + " ! appsink name=out",
      3, [&] { EXPECT_TRUE(std::filesystem::remove(light)) << "nothing was written"; });
  for (const LineResult& run : runs) {
    EXPECT_TRUE(run.eos) << run.first_error();
    ASSERT_EQ(run.frames.size(), 8u);
    EXPECT_EQ(run.frames, runs[0].frames);
    EXPECT_EQ(run.messages, std::vector<std::string>{"material"});
    EXPECT_TRUE(run.warnings.empty());
  }
  EXPECT_TRUE(std::filesystem::exists(light));
}

TEST_F(LimeElementTest, BindingsReceiveTheMaterial) {
  VideoHarness harness(line(), caps());
  GstElement* lime = harness.find("limematerial");
  std::vector<std::pair<std::string, bool>> heard;  // and whether there is a value
  g_signal_connect(lime, "notify",
                   G_CALLBACK(+[](GObject* object, GParamSpec* spec, gpointer names) {
                     GValue value = G_VALUE_INIT;
                     g_object_get_property(object, spec->name, &value);  // must not wait
                     const bool known = !g_param_value_defaults(spec, &value);
                     g_value_unset(&value);
                     static_cast<decltype(heard)*>(names)->emplace_back(spec->name, known);
                   }),
                   &heard);
  for (int i = 0; i < 8; ++i) harness.process(scene(60, 30, 20));
  decltype(heard) expected{
      {"diffuse-albedo", true}, {"specular-albedo", true}, {"shininess", true}};
  EXPECT_EQ(heard, expected);
  for (int i = 0; i < 4; ++i) harness.process(scene(0, 0, 0));
  for (size_t i = 0; i < 3; ++i) expected.emplace_back(expected[i].first, false);
  EXPECT_EQ(heard, expected);
}

TEST_F(LimeElementTest, ModelsThatAreMissingAreAnError) {
  const auto error = [](const std::string& models) {
    return run_line("videotestsrc num-buffers=2 ! limematerial models=" + models + " ! fakesink")
        .first_error();
  };
  const auto none = error("/nowhere");
  expect_contains(none, "there is no folder /nowhere/lime");
  expect_contains(none, "INVERSE_MODELS");  // what to do
  std::filesystem::remove(files.path("albedo"));
  expect_contains(error(files.folder()), "albedo.net");
}

TEST_F(LimeElementTest, ModelsAreReadAtEveryStart) {
  GstElement* lime = gst_element_factory_make("limematerial", nullptr);
  g_object_set(lime, "models", files.folder().c_str(), nullptr);
  EXPECT_EQ(gst_element_set_state(lime, GST_STATE_PAUSED), GST_STATE_CHANGE_SUCCESS);
  gst_element_set_state(lime, GST_STATE_READY);
  std::filesystem::resize_file(files.path("albedo"), 100);
  EXPECT_EQ(gst_element_set_state(lime, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  gst_element_set_state(lime, GST_STATE_NULL);
  gst_object_unref(lime);
}

// With the networks that come along: a glossy ball of one color before a checkered wall.
namespace {

/// A glossy blue ball before checks, RGBA.
std::vector<uint8_t> ball(int width, int height, double x0, double y0, double radius) {
  const double albedo[3] = {.08, .35, .5};
  return draw(width, height, [&](int x, int y, int c) {
    const double nx = (x - x0) / radius, ny = (y - y0) / radius, r2 = nx * nx + ny * ny;
    double light = ((x / 24 + y / 24) % 2 ? .30 : .18) * (c == 2 ? .6 : 1);
    if (r2 < 1) {
      const double nz = std::sqrt(1 - r2), facing = -.48 * nx - .48 * ny + .73 * nz;
      const double half = -.26 * nx - .26 * ny + .93 * nz;
      light = albedo[c] * (.25 + .9 * std::max(0., facing)) + .8 * std::pow(std::max(0., half), 60);
    }
    return std::lround(255 * std::clamp(srgb_code(light), 0., 1.));
  });
}

}  // namespace

TEST_F(LimeElementTest, BundledNetworksFindABall) {
  if (!has_networks()) GTEST_SKIP() << "built without inverse-onnx-import";
  constexpr int kSide = 256, kRadius = 85;
  const auto picture = ball(kSide, kSide, 128, 128, kRadius);
  VideoHarness harness("limematerial show=specular", caps(kSide, kSide), caps(kSide, kSide));
  GstElement* lime = harness.find("limematerial");
  const auto highlights = harness.process(picture, 8);
  ASSERT_TRUE(stat<bool>(lime, "found"));
  EXPECT_NEAR(stat<double>(lime, "left"), 128 - kRadius, 12);
  EXPECT_NEAR(stat<double>(lime, "bottom"), 128 + kRadius, 12);
  const double red = stat<double>(lime, "diffuse-red");
  const double blue = stat<double>(lime, "diffuse-blue");
  EXPECT_LT(red, .6 * blue) << "of a blue ball";
  const auto at = [&](int x, int y) { return highlights[4 * (size_t{256} * y + x)]; };
  EXPECT_GT(at(104, 104), 150) << "where the highlight is";
  EXPECT_LT(at(160, 160), 90) << "where none is";
  EXPECT_EQ(at(10, 10), 0) << "outside of the ball";
}

TEST_F(LimeElementTest, BundledNetworksFindABallThatTheFrameCuts) {
  if (!has_networks()) GTEST_SKIP() << "built without inverse-onnx-import";
  constexpr int kWide = 320, kHigh = 240;
  for (const double share : {.4, .65, .8}) {  // radius over the frame's height
    VideoHarness harness("limematerial show=input", caps(kWide, kHigh), caps(kWide, kHigh));
    GstElement* lime = harness.find("limematerial");
    const auto picture = ball(kWide, kHigh, 130, 120, share * kHigh);
    for (int i = 0; i < 10; ++i) harness.process(picture);
    ASSERT_TRUE(stat<bool>(lime, "found")) << share;
    const auto edge = [&](const char* name) { return stat<double>(lime, name); };
    EXPECT_NEAR(edge("left"), std::max(130 - share * kHigh, 0.), 12) << share;
    EXPECT_NEAR(edge("right"), std::min(130 + share * kHigh, 320.), 12) << share;
    EXPECT_NEAR(edge("top"), std::max(120 - share * kHigh, 0.), 12) << share;
    EXPECT_NEAR(edge("bottom"), std::min(120 + share * kHigh, 240.), 12) << share;
    EXPECT_LT(edge("diffuse-red"), .6 * edge("diffuse-blue")) << "of a blue ball";
  }
}

TEST_F(LimeElementTest, WorksBehindOtherFormatsAndBesideOtherElements) {
  const auto result = run_line(
      "videotestsrc num-buffers=6 pattern=ball ! video/x-raw,format=NV12,width=160,height=120 ! "
      "limematerial models=" +
      files.folder() + " ! intrinsicdecomp ! video/x-raw,format=I420 ! appsink name=out");
  EXPECT_TRUE(result.eos) << result.first_error();
  EXPECT_EQ(result.frames.size(), 6u);
}

}  // namespace inverse::testing
