// SPDX-License-Identifier: LGPL-2.1-or-later
// olatrelight.
#include <gst/app/gstappsrc.h>
#include <gst/controller/controller.h>
#include <gst/video/navigation.h>
#include <sys/stat.h>

#include <limits>
#include <set>

#include "gst/base/build_stamp.hpp"
#include "gst/inverse/inverse_layers_meta.h"
#include "kernels/image/layers.hpp"
#include "relight_fixture.hpp"
#include "tests/replaced_file.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {

TEST_F(RelightTest, UnderWhiteLightTheSubjectIsAsUnderAllLights) {
  VideoHarness harness("olatrelight environment-location=" + white(), caps(), caps(kSide));
  const auto relit = harness.process(sphere.side_by_side());
  ASSERT_EQ(relit.size(), size_t{kSide} * kSide * 4);
  gst_util_set_object_arg(G_OBJECT(harness.find("olatrelight")), "show", "full-on");
  const auto full = harness.process(sphere.side_by_side());
  int worst = 0;
  for (int y = 0; y < kSide * 3 / 4; ++y)  // what faces the floor that has no lights is darker
    for (int x = 0; x < kSide; ++x)
      for (int c = 0; c < 3; ++c)
        update_max(worst, std::abs(at(relit, x, y)[c] - at(full, x, y)[c]));
  EXPECT_LE(worst, 6);
  const double expected =
      encoded(double{sphere.a[4 * (32 * kSide + 32)]} + sphere.b[4 * (32 * kSide + 32)]);
  EXPECT_NEAR(at(full, 32, 32)[0], 255 * expected, 2);
}

TEST_F(RelightTest, LightComesFromWhereItIsAndTurns) {
  VideoHarness harness("olatrelight environment-location=" + lamp_file(90, 90, 20), caps(),
                       caps(kSide));
  GstElement* relight = harness.find("olatrelight");
  auto out = harness.process(sphere.side_by_side());
  EXPECT_GT(at(out, 50, 32)[0], at(out, 14, 32)[0] + 60) << "from the right";
  EXPECT_GT(at(out, 50, 32)[0], at(out, 50, 32)[2] + 30) << "yellow";
  g_object_set(relight, "environment-rotation", 180.0F, nullptr);
  out = harness.process(sphere.side_by_side());
  EXPECT_GT(at(out, 14, 32)[0], at(out, 50, 32)[0] + 60) << "turned to the left";
  EXPECT_FALSE(stat<bool>(relight, "fitted")) << "the picture is the same";
  const int before = at(out, 14, 32)[1];
  g_object_set(relight, "exposure", -2.0F, nullptr);
  out = harness.process(sphere.side_by_side());
  EXPECT_LT(at(out, 14, 32)[1], before - 30);
  EXPECT_EQ(stat<guint64>(relight, "lights"), 331u);
  EXPECT_LT(stat<guint64>(relight, "lit"), 12u);
  EXPECT_NEAR(stat<double>(relight, "environment-shown"), 1, 1e-3);
}

TEST_F(RelightTest, DirectionsAreTheNormalsOfASphere) {
  VideoHarness harness("olatrelight show=normal", caps(), caps(kSide));
  const auto out = harness.process(sphere.side_by_side());
  for (const auto& [x, y] : {std::pair{32, 32}, {48, 32}, {32, 14}, {20, 40}}) {
    const double px = 2 * (x + .5) / kSide - 1, py = 1 - 2 * (y + .5) / kSide;
    EXPECT_NEAR(at(out, x, y)[0], 255 * (.5 + .5 * px), 4) << x << " " << y;
    EXPECT_NEAR(at(out, x, y)[1], 255 * (.5 + .5 * py), 4) << x << " " << y;
  }
  EXPECT_EQ(at(out, 1, 1)[0], 0) << "where there is no light there is no direction";
}

TEST_F(RelightTest, LabelsMustMatchTheExpectedLight) {
  const std::string camera =
      "lightstagetestsrc is-live=false num-buffers=24 program=performance:42 ! "
      "video/x-raw,format=RGBA,width=64,height=32 ! ";
  const std::string sync = "lightstagesync program=performance:42 ";
  const auto alone = run_line(camera + sync + "! olatrelight program=performance:42 ! fakesink");
  expect_contains(alone.first_error(), "assemble=pairs");
  const auto relit = [&](const std::string& program) {
    return run_line(camera + sync + "assemble=pairs ! olatrelight program=" + program +
                    " ! fakesink");
  };
  const auto same = relit("performance:42"), as_good = relit("static:42"),
             other = relit("performance");
  for (const auto& result : {same, as_good, other}) EXPECT_TRUE(result.eos) << result.first_error();
  EXPECT_TRUE(same.warnings.empty());
  EXPECT_TRUE(as_good.warnings.empty());
  expect_one(other.warnings, "42 lights");  // once, not with every frame
}

TEST_F(RelightTest, LayersAreTakenAsPairsSideBySideAre) {
  const std::string layers =
      "video/x-raw(meta:InverseLayers), format=RGBA, layers=gradients, width=64, height=64, "
      "framerate=25/1";
  for (const char* properties : {"", " show=normal", " show=full-on"}) {
    VideoHarness plain(std::string("olatrelight") + properties, caps(), caps(kSide));
    const auto expected = plain.process(sphere.side_by_side());
    VideoHarness harness(std::string("olatrelight") + properties, layers, caps(kSide));
    const auto device = gpu::Device::open();
    const auto plane = [&](const std::vector<float>& pixels) {
      auto buffer =
          gpu::Buffer::create(device, gpu::Element::vec4, pixels.size() / 4, gpu::Memory::upload);
      std::copy(pixels.begin(), pixels.end(), buffer->map_as<float>());
      return std::make_shared<Plane>(Plane{{kSide, kSide}, buffer});
    };
    const auto push = [&](const Layers& what) {
      GstBuffer* buffer = gst_buffer_new();
      auto* meta = reinterpret_cast<GstInverseLayersMeta*>(gst_buffer_add_meta(
          buffer, gst_meta_get_info("GstInverseLayersMeta-" BUILD_STAMP), nullptr));
      meta->width = meta->height = kSide;
      *static_cast<Layers*>(meta->layers) = what;
      GST_BUFFER_PTS(buffer) = 0;
      return gst_harness_push(harness.harness(), buffer);
    };
    const Layers pair = gradient_layers(plane(sphere.a), plane(sphere.b));
    ASSERT_EQ(push(pair), GST_FLOW_OK);
    const auto got = harness.pull();
    EXPECT_LE(largest_difference(got, expected), 3) << properties;
    ASSERT_EQ(push(pair), GST_FLOW_OK);
    EXPECT_EQ(harness.pull(), got);
    EXPECT_TRUE(stat<bool>(harness.find("olatrelight"), "reused"));
    // Pairs of two sizes, and half a pair.
    Layers odd = pair;
    odd[Role::gradient_b] =
        std::make_shared<Plane>(Plane{{8, 8}, gpu::Buffer::create(device, gpu::Element::vec4, 64)});
    EXPECT_EQ(push(odd), GST_FLOW_ERROR);
    odd[Role::gradient_b] = nullptr;
    EXPECT_EQ(push(odd), GST_FLOW_ERROR);
    for (const std::string& error : harness.errors()) expect_contains(error, "gradients");
  }
}

TEST_F(RelightTest, OneLightFollowsItsDirection) {
  VideoHarness harness("olatrelight show=olat light-direction=1,0,0.2", caps(), caps(kSide));
  GstElement* relight = harness.find("olatrelight");
  auto out = harness.process(sphere.side_by_side());
  EXPECT_GT(at(out, 52, 32)[0], at(out, 12, 32)[0] + 60);
  g_object_set(relight, "light-direction", "-3, 0 ,1", nullptr);
  out = harness.process(sphere.side_by_side());
  EXPECT_GT(at(out, 12, 32)[0], at(out, 52, 32)[0] + 60);
  EXPECT_EQ(property<gfloat>(relight, "light-x"), -3);
  g_object_set(relight, "light-x", 0.0F, "light-y", 1.0F, "light-z", 0.0F, nullptr);
  out = harness.process(sphere.side_by_side());
  EXPECT_GT(at(out, 32, 8)[0], at(out, 32, 50)[0] + 60);
  EXPECT_EQ(property<std::string>(relight, "light-direction"), "0,1,0");
  // What is no direction changes nothing.
  const auto quiet = g_log_set_default_handler([](auto...) {}, nullptr);
  for (const char* bad : {"", "1,2", "a,b,c", "1,2,3,4", "nan,0,0", "1e30,0,0"})
    g_object_set(relight, "light-direction", bad, nullptr);
  g_log_set_default_handler(quiet, nullptr);
  EXPECT_EQ(harness.process(sphere.side_by_side()), out);
  g_object_set(relight, "light-direction", "0,0,0", nullptr);
  const auto none = harness.process(sphere.side_by_side());
  g_object_set(relight, "light-direction", "0,0,1", nullptr);
  EXPECT_EQ(harness.process(sphere.side_by_side()), none) << "from the camera";
}

TEST_F(RelightTest, TheMouseMovesTheLight) {
  VideoHarness harness("olatrelight show=olat", caps(), caps(kSide));
  GstElement* relight = harness.find("olatrelight");
  const auto send = [&](GstEvent* event) { harness.send_upstream(event); };
  const auto none = GST_NAVIGATION_MODIFIER_NONE;
  harness.process(sphere.side_by_side());
  send(gst_navigation_event_new_mouse_move(8, 32, none));
  EXPECT_EQ(property<gfloat>(relight, "light-x"), .5F) << "not before its button is down";
  send(gst_navigation_event_new_mouse_button_press(1, 8, 32, none));
  EXPECT_NEAR(property<gfloat>(relight, "light-x"), -.75, 1e-5);
  send(gst_navigation_event_new_mouse_move(32, 0, none));
  EXPECT_NEAR(property<gfloat>(relight, "light-y"), 1, 1e-5);
  send(gst_navigation_event_new_mouse_move(NAN, 1e300, none));
  const auto out = harness.process(sphere.side_by_side());
  EXPECT_GT(at(out, 32, 8)[0], at(out, 32, 50)[0] + 60);
  send(gst_navigation_event_new_mouse_button_release(1, 32, 0, none));
  send(gst_navigation_event_new_mouse_move(60, 32, none));
  EXPECT_NEAR(property<gfloat>(relight, "light-y"), 1, 1e-5);
}

TEST_F(RelightTest, RotationFollowsAController) {
  const std::string environment = lamp_file(50, 50, 50);
  const auto result = run_line(
      "appsrc name=in ! olatrelight name=relight environment-location=" + environment +
          " ! video/x-raw,format=RGBA ! appsink name=out",
      60, [this](GstElement* pipeline) {
        GstElement* relight = find_element(pipeline, "relight");
        GstControlSource* source = gst_interpolation_control_source_new();
        g_object_set(source, "mode", GST_INTERPOLATION_MODE_LINEAR, nullptr);
        auto* values = reinterpret_cast<GstTimedValueControlSource*>(source);
        gst_timed_value_control_source_set(values, 0, 0);
        gst_timed_value_control_source_set(values, GST_SECOND, 180);
        ASSERT_TRUE(gst_object_add_control_binding(
            GST_OBJECT(relight), gst_direct_control_binding_new_absolute(
                                     GST_OBJECT(relight), "environment-rotation", source)));
        gst_object_unref(source);
        GstElement* in = find_element(pipeline, "in");
        GstCaps* frame_caps = gst_caps_from_string(caps().c_str());
        g_object_set(in, "caps", frame_caps, "format", GST_FORMAT_TIME, nullptr);
        gst_caps_unref(frame_caps);
        const auto bytes = sphere.side_by_side();
        for (const GstClockTime time : {GstClockTime{0}, GstClockTime{GST_SECOND}}) {
          GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
          GST_BUFFER_PTS(buffer) = time;
          gst_app_src_push_buffer(GST_APP_SRC(in), buffer);
        }
        gst_app_src_end_of_stream(GST_APP_SRC(in));
      });
  ASSERT_TRUE(result.eos) << result.first_error();
  ASSERT_EQ(result.frames.size(), 2u);
  EXPECT_GT(at(result.frames[0], 50, 32)[0], at(result.frames[0], 14, 32)[0] + 60);
  EXPECT_GT(at(result.frames[1], 14, 32)[0], at(result.frames[1], 50, 32)[0] + 60);
}

TEST_F(RelightTest, RepeatedFramesAreReused) {
  VideoHarness harness("olatrelight", caps(), caps(kSide));
  GstElement* relight = harness.find("olatrelight");
  const auto first = harness.process(sphere.side_by_side());
  EXPECT_TRUE(stat<bool>(relight, "fitted"));
  EXPECT_EQ(harness.process(sphere.side_by_side()), first);
  EXPECT_FALSE(stat<bool>(relight, "fitted"));
  EXPECT_TRUE(stat<bool>(relight, "reused"));
  auto other = sphere.side_by_side();
  other[4 * (32 * 128 + 32)] ^= 0x40;
  EXPECT_NE(harness.process(other), first);
  EXPECT_FALSE(stat<bool>(relight, "reused"));
  g_object_set(relight, "adaptive", FALSE, nullptr);
  const auto all = harness.process(sphere.side_by_side());
  EXPECT_LE(largest_difference(all, first), 2) << "the table is near the sum";
  EXPECT_EQ(harness.process(sphere.side_by_side()), all);
  EXPECT_FALSE(stat<bool>(relight, "reused"));
}

TEST_F(RelightTest, EveryPropertyMayChangeWhilePlaying) {
  VideoHarness harness("olatrelight", caps(), caps(kSide));
  GstElement* relight = harness.find("olatrelight");
  auto before = harness.process(sphere.side_by_side());
  const auto changes = [&](const char* name, const char* value) {
    gst_util_set_object_arg(G_OBJECT(relight), name, value);
    const auto after = harness.process(sphere.side_by_side());
    EXPECT_GT(largest_difference(after, before), 2) << name << " " << value;
    before = after;
  };
  changes("environment-rotation", "120");
  changes("exposure", "-1.5");
  changes("tuning", "noise=0.8");
  for (const char* show : {"olat", "normal", "full-on", "mosaic", "relit"}) changes("show", show);
  for (const std::string& file : {white(2), std::string()}) {
    g_object_set(relight, "environment-location", file.c_str(), nullptr);
    const auto after = lit_by(harness, file.empty() ? "studio" : file);
    EXPECT_GT(largest_difference(after, before), 2) << file;
    before = after;
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(RelightTest, SizesFormatsAndNewCaps) {
  VideoHarness harness("olatrelight show=mosaic", caps());
  for (const auto& [width, height] :
       {std::pair{2, 1}, {16, 16}, {66, 33}, {400, 120}, {1280, 16}}) {
    harness.set_src_caps(caps(width, height));
    const auto out = harness.process(random_frame(caps(width, height), 7), 2);
    EXPECT_EQ(out.size(), static_cast<size_t>(width / 2 * height * 4));
    harness.flush();
  }
  for (const char* format : {"I420", "NV12", "BGRx", "RGB", "GRAY8", "P010_10LE", "RGBA64_LE"}) {
    harness.set_src_caps(caps(64, 48, format));
    ASSERT_FALSE(harness.process(random_frame(caps(64, 48, format), 1)).empty()) << format;
  }
  for (const uint8_t value : {0, 255}) {
    harness.set_src_caps(caps(64, 48));
    ASSERT_FALSE(harness.process(flat_frame(caps(64, 48), value)).empty());
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(RelightTest, FramesThatCannotBeHalvedAreErrors) {
  VideoHarness harness("olatrelight", caps(65, 32));
  EXPECT_NE(harness.push(random_frame(caps(65, 32), 1)), GST_FLOW_OK);
  expect_one(harness.errors(), "side by side", "65");
  expect_contains(run("", 101).first_error(), "side by side");
  // The output's width determines the input's.
  const auto result = run_line(
      "videotestsrc num-buffers=1 ! olatrelight ! video/x-raw,width=50,height=20 ! "
      "appsink name=out");
  EXPECT_TRUE(result.eos) << result.first_error();
  EXPECT_EQ(GST_VIDEO_INFO_WIDTH(&result.info), 50);
}

TEST_F(RelightTest, BadFilesAreErrorsWithTheirCause) {
  expect_contains(error_of("environment-location=/nowhere/a.hdr"), "/nowhere/a.hdr cannot be read");
  expect_contains(error_of("program=/nowhere/a.json"), "/nowhere/a.json");
  expect_contains(error_of("program=performance:0"), "number of lights");
  const std::string lamp_path = lamp_file(1, 1, 1);
  std::filesystem::resize_file(lamp_path, std::filesystem::file_size(lamp_path) / 2);
  expect_contains(error_of("environment-location=" + lamp_path), "ends too early");
  const std::string exr_path = exr(1);
  std::filesystem::resize_file(exr_path, std::filesystem::file_size(exr_path) / 2);
  expect_contains(error_of("environment-location=" + exr_path), "map.exr");
  expect_contains(error_of("environment-location=" + exr(1, 60)), "60x32");
  const std::string pipe = folder / "pipe.hdr";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_contains(error_of("environment-location=" + pipe), "pipe.hdr is no file");
  const LineResult good = run("environment-location=" + exr(1));
  EXPECT_TRUE(good.warnings.empty());
  EXPECT_EQ(good.first_error(), "");
}

TEST_F(RelightTest, InvalidRadianceIsClampedWithAWarning) {
  for (const float odd :
       {-1.0F, std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
        std::numeric_limits<float>::quiet_NaN()}) {
    const LineResult result = run("environment-location=" + exr(odd));
    EXPECT_EQ(result.first_error(), "") << odd;
    expect_one(result.warnings, "clamped");
  }
}

TEST_F(RelightTest, MapsOfSingleFloatsAreTakenAsTheyAre) {
  const std::string views = float_exr({"View.R", "View.G", "View.B"}, 1);
  expect_contains(error_of("environment-location=" + views), "View.G");
  // More than a half float holds, but a sun has it.
  for (const auto& [channels, odd] :
       {std::pair{std::vector{"R", "G", "B"}, 1e5F}, {std::vector{"Y"}, 2}}) {
    const LineResult result = run("environment-location=" + float_exr(channels, odd));
    EXPECT_TRUE(result.warnings.empty());
    EXPECT_EQ(result.first_error(), "");
  }
}

TEST_F(RelightTest, AnUnreadableEnvironmentLeavesTheLightUnchanged) {
  VideoHarness harness("olatrelight", caps(), caps(kSide));
  GstElement* relight = harness.find("olatrelight");
  const auto before = harness.process(sphere.side_by_side());
  const std::string file = folder / "white.hdr";
  g_object_set(relight, "environment-location", file.c_str(), nullptr);
  std::vector<std::string> warnings;
  while (warnings.empty()) {
    ASSERT_EQ(harness.process(sphere.side_by_side()), before);
    g_usleep(1000);
    warnings = harness.warnings();
  }
  EXPECT_EQ(harness.process(sphere.side_by_side()), before);
  expect_one(warnings, "white.hdr cannot be read", "the light before stays");
  EXPECT_TRUE(harness.errors().empty());
  // Set again once the file exists.
  g_object_set(relight, "environment-location", "", nullptr);
  EXPECT_EQ(harness.process(sphere.side_by_side()), before);
  ASSERT_EQ(white(3), file);
  g_object_set(relight, "environment-location", file.c_str(), nullptr);
  EXPECT_NE(lit_by(harness, file), before);
}

TEST_F(RelightTest, FramesGoOnWhileAnEnvironmentIsRead) {
  VideoHarness harness("olatrelight", caps(), caps(kSide));
  GstElement* relight = harness.find("olatrelight");
  const auto before = harness.process(sphere.side_by_side());
  const std::string slow = white(3), other = lamp_file(9, 9, 2);
  HeldFile held(slow);
  if (!held.works()) GTEST_SKIP() << "no leases on this file system";
  g_object_set(relight, "environment-location", slow.c_str(), nullptr);
  for (int i = 0; i < 5 || !held.is_wanted(); ++i) {
    ASSERT_EQ(harness.process(sphere.side_by_side()), before);
    ASSERT_EQ(stat<std::string>(relight, "environment"), "studio");
  }
  // One that was not asked for any more is not shown.
  g_object_set(relight, "environment-location", other.c_str(), nullptr);
  EXPECT_EQ(harness.process(sphere.side_by_side()), before);
  held.release();
  std::set<std::string> shown;
  while (!shown.contains(other)) {
    harness.process(sphere.side_by_side());
    shown.insert(stat<std::string>(relight, "environment"));
  }
  EXPECT_FALSE(shown.contains(slow));
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(RelightTest, AStreamThatIsNotAssembledIsAWarningWithItsRemedy) {
  const std::string camera =
      "lightstagetestsrc is-live=false num-buffers=8 program=performance:42 ! "
      "video/x-raw,format=RGBA,width=64,height=32 ! ";
  const std::string relight = "olatrelight program=performance:42 ! fakesink";
  for (const std::string& between :
       {std::string(), std::string("queue ! videoconvert ! "),
        // None of its frames has a label.
        std::string("lightstagesync program=static:42 tuning=drop-unlabeled=false ! ")}) {
    const LineResult result = run_line(camera + between + relight);
    EXPECT_EQ(result.first_error(), "");
    const auto halves = std::ranges::count_if(result.warnings, [](const std::string& text) {
      return text.find("lightstagesync assemble=pairs") != std::string::npos;
    });
    EXPECT_EQ(halves, 1) << between;
  }
  // Two pictures side by side, by other means.
  const LineResult pairs = run_line(
      "compositor name=c sink_1::xpos=64 ! video/x-raw,format=RGBA,width=128,height=32 ! " +
      relight + " " + camera + "c. " + camera + "c.");
  EXPECT_EQ(pairs.first_error(), "");
  EXPECT_TRUE(pairs.warnings.empty());
}

TEST_F(RelightTest, LargeFramesWorkOrAreOneError) {
  const auto result = run_line(
      "videotestsrc num-buffers=1 pattern=smpte ! "
      "video/x-raw,format=I420,width=7680,height=4320 ! olatrelight ! fakesink",
      120);
  if (result.eos) return;
  // The one thing that may not fit is a plane, and the error says how large and what to do.
  const std::string& error = result.first_error();
  EXPECT_EQ(error.find("olatrelight: a buffer of 265420800 bytes exceeds maxStorageBufferRange"),
            0U)
      << error;
  expect_contains(error, "; use a smaller frame or another device");
}

TEST_F(RelightTest, GrayGradientsAreAWarning) {
  const auto result = run_line(
      "videotestsrc num-buffers=3 ! video/x-raw,format=GRAY8,width=64,height=32 ! olatrelight ! "
      "fakesink");
  EXPECT_TRUE(result.eos) << result.first_error();
  expect_one(result.warnings, "gray video");
  // As layers they no longer report it.
  const auto pairs = run_line(
      "lightstagetestsrc is-live=false num-buffers=14 program=performance:24 ! "
      "video/x-raw,format=GRAY8,width=64,height=48 ! lightstagesync program=performance:24 "
      "assemble=pairs ! olatrelight program=performance:24 ! fakesink");
  EXPECT_TRUE(pairs.eos) << pairs.first_error();
  expect_one(pairs.warnings, "gray video");
}

}  // namespace inverse::testing
