// SPDX-License-Identifier: LGPL-2.1-or-later
// materialclone.
#include <gst/app/gstappsrc.h>
#include <gst/video/navigation.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "gst/inverse/inverse_material_meta.h"
#include "kernels/environment/environment.hpp"
#include "lime_fixture.hpp"
#include "tests/elements/lamp.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

constexpr int kSide = 96;
/// A corner of a cube.
constexpr const char* kWedge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\n";

class CloneTest : public LimeElementTest {
 protected:
  static std::string frame_caps(int width = kSide, int height = kSide,
                                const char* format = "RGBA") {
    return VideoHarness::caps(format, width, height);
  }
  static std::vector<uint8_t> gray(int width = kSide, int height = kSide) {
    return flat_frame(frame_caps(width, height), 128);
  }
  static const uint8_t* at(const std::vector<uint8_t>& frame, int x, int y, int width = kSide) {
    return pixel_at(frame, x, y, width);
  }
  std::string written(const std::string& name, const std::string& bytes) const {
    return folder_.write(name, bytes);
  }
  std::string lamp_file(float red, float green, float blue) const {
    std::string path = folder_ / "lamp.hdr";
    lamp(4, red, green, blue).save(path);
    return path;
  }

  /// The same in OpenEXR; `odd` in the red of its last pixel, where that is given.
  std::string lamp_exr(float red, float green, float blue, std::optional<float> odd = {}) const {
    const Environment map = lamp(4, red, green, blue);
    const size_t width = map.extent().width;
    std::vector<Imf::Rgba> pixels(map.extent().pixels());
    for (size_t i = 0; i < pixels.size(); ++i) {  // as an observer facing the camera sees it
      const float* rgb = &map.rgb()[3 * (i / width * width + width - 1 - i % width)];
      pixels[i] = Imf::Rgba(rgb[0], rgb[1], rgb[2]);
    }
    if (odd) pixels.back().r = *odd;
    return write_exr(folder_ / "lamp.exr", static_cast<int>(width), pixels);
  }
  /// The result of two frames that are drawn into.
  static LineResult run(const std::string& properties) {
    return run_line("videotestsrc num-buffers=2 ! materialclone " + properties + " ! fakesink");
  }

  TemporaryFolder folder_;
};

}  // namespace

TEST_F(CloneTest, PixelsThatAreNotSquareAreWarnedOf) {
  VideoHarness harness("materialclone source=properties",
                       VideoHarness::caps("RGBA", kSide, kSide, "pixel-aspect-ratio=2/1"));
  ASSERT_FALSE(harness.process(gray()).empty());
  expect_one(harness.warnings(), "2:1");
}

TEST_F(CloneTest, DrawsABallByDefault) {
  VideoHarness harness("materialclone diffuse-color=0xffff0000 specular=0", frame_caps(),
                       frame_caps());
  const auto out = harness.process(gray());
  ASSERT_EQ(out.size(), gray().size());
  const uint8_t* middle = at(out, 48, 44);
  EXPECT_GT(middle[0], 100);
  EXPECT_EQ(middle[1], 0);
  EXPECT_EQ(at(out, 3, 3)[0], 128) << "nothing else is touched";
  EXPECT_LT(at(out, 48, 74)[0], 120) << "its shadow";
  EXPECT_GT(at(out, 34, 38)[0], at(out, 62, 60)[0]) << "the studio's light comes from up left";
  GstElement* clone = harness.find("materialclone");
  EXPECT_EQ(stat<std::string>(clone, "material"), "properties");
  EXPECT_EQ(stat<std::string>(clone, "light"), "studio");
}

TEST_F(CloneTest, TakesTheMaterialOfTheStreamAndHoldsIt) {
  VideoHarness harness(
      line("show=input") + " ! materialclone name=clone source=stream size=0.3 x=0.15", caps(),
      caps());
  GstElement* clone = harness.find("materialclone");
  harness.process(scene(0, 0, 0));
  EXPECT_EQ(stat<std::string>(clone, "material"), "properties");
  harness.process(scene(60, 30, 20), 8);
  EXPECT_EQ(stat<std::string>(clone, "material"), "stream");
  EXPECT_NEAR(stat<double>(clone, "diffuse-blue"), .7, 1e-2);
  const Buffer out = harness.process_buffer(scene(60, 30, 20));
  const GstMaterialMeta* meta = gst_buffer_get_material_meta(out.get());
  ASSERT_NE(meta, nullptr) << "it travels on";
  EXPECT_TRUE(meta->found);
  harness.process(scene(0, 0, 0), 12);
  EXPECT_EQ(stat<std::string>(clone, "material"), "held");
  EXPECT_NEAR(stat<double>(clone, "diffuse-blue"), .7, 1e-2);
  gst_util_set_object_arg(G_OBJECT(clone), "source", "properties");
  harness.process(scene(0, 0, 0));
  EXPECT_EQ(stat<std::string>(clone, "material"), "properties");
}

TEST_F(CloneTest, MaterialsPassElementsThatConvertAndScale) {
  VideoHarness harness(line("show=input estimate-light=true") +
                           " ! videoconvert ! video/x-raw,format=I420 ! videoscale ! "
                           "video/x-raw,width=64,height=96 ! materialclone size=0.3 x=0.15",
                       caps());
  harness.process(scene(60, 30, 20), 8);
  GstElement* clone = harness.find("materialclone");
  EXPECT_EQ(stat<std::string>(clone, "material"), "stream");
  EXPECT_EQ(stat<std::string>(clone, "light"), "estimate");
  EXPECT_NEAR(stat<double>(clone, "diffuse-blue"), .7, 1e-2);
}

TEST_F(CloneTest, AStreamWithoutMaterialsIsAWarning) {
  const auto warnings = [](const std::string& between, const std::string& properties = "") {
    const auto result = run_line(
        "videotestsrc num-buffers=4 pattern=black ! "
        "video/x-raw,format=RGBA,width=96,height=64 ! " +
        between + "materialclone " + properties + " ! fakesink");
    EXPECT_TRUE(result.eos) << result.first_error();
    return result.warnings;
  };
  const std::string lime = line("show=input") + " ! ";
  expect_one(warnings(lime), "before limematerial found an object");
  expect_one(warnings(lime + "videoconvert ! video/x-raw,format=I420 ! "),
             "before limematerial found an object");
  EXPECT_TRUE(warnings(lime, "source=properties").empty());
  EXPECT_TRUE(warnings("", "source=properties").empty());
  for (const std::string& between :
       {std::string(), lime + "videoflip video-direction=180 ! ", lime + "videocrop top=10 ! "}) {
    SCOPED_TRACE(between);
    expect_one(warnings(between), "put limematerial before this element");
  }
}

TEST_F(CloneTest, AnObjectThatIsNotFoundOrIsLostIsWarnedOfEachTime) {
  VideoHarness harness(line("show=input") + " ! materialclone size=0.3 x=0.15", caps(), caps());
  const auto warnings_after = [&](const std::vector<uint8_t>& frame, int times) {
    harness.process(frame, times);
    return harness.warnings();
  };
  const auto nothing = scene(0, 0, 0), object = scene(60, 30, 20);
  EXPECT_TRUE(warnings_after(nothing, 3).empty()) << "it may come yet";
  expect_one(warnings_after(nothing, 30), "limematerial finds no object in the video",
             "diffuse-color, specular and shininess are drawn", "a third of the picture");
  EXPECT_TRUE(warnings_after(object, 8).empty());
  expect_one(warnings_after(nothing, 30), "its last material is drawn");
  EXPECT_TRUE(warnings_after(object, 8).empty());
  EXPECT_TRUE(warnings_after(nothing, 5).empty()) << "it may have been hidden";
  EXPECT_TRUE(warnings_after(object, 8).empty());
  expect_one(warnings_after(nothing, 30), "its last material is drawn");
  gst_harness_push_event(harness.harness(), gst_event_new_eos());
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_F(CloneTest, LightOfAFileComesFromWhereItIs) {
  const std::string lamp = lamp_file(8, 8, 2);
  VideoHarness harness("materialclone specular=0 size=0.8 environment-location=" + lamp,
                       frame_caps(), frame_caps());
  auto out = harness.process(gray());
  EXPECT_GT(at(out, 70, 48)[0], at(out, 26, 48)[0] + 40) << "from the right";
  EXPECT_GT(at(out, 70, 48)[0], at(out, 70, 48)[2]) << "yellow";
  GstElement* clone = harness.find("materialclone");
  EXPECT_EQ(stat<std::string>(clone, "light"), "file");
  const int before = at(out, 70, 48)[1];
  g_object_set(clone, "exposure", -2.0F, nullptr);
  out = harness.process(gray());
  EXPECT_LT(at(out, 70, 48)[1], before - 30);
  g_object_set(clone, "exposure", 0.0F, "tuning", "environment-rotation=180", nullptr);
  out = harness.process(gray());
  EXPECT_GT(at(out, 26, 48)[0], at(out, 70, 48)[0] + 40) << "turned to the left";
}

TEST_F(CloneTest, LightOfAnOpenExrFileIsThatOfTheSameMapInRadiance) {
  const auto drawn = [](const std::string& path) {
    VideoHarness harness("materialclone specular=0.5 size=0.8 environment-location=" + path,
                         frame_caps(), frame_caps());
    return harness.process(gray());
  };
  EXPECT_EQ(drawn(lamp_exr(8, 4, 2)), drawn(lamp_file(8, 4, 2)));
  const auto warnings = [](const std::string& path) {
    return run("source=properties environment-location=" + path).warnings;
  };
  EXPECT_TRUE(warnings(lamp_exr(8, 4, 2)).empty());
  expect_one(warnings(lamp_exr(8, 4, 2, -1.0F)), "1 values that are no radiance");
}

TEST_F(CloneTest, LightOfTheStreamIsTakenUnlessInvalid) {
  VideoHarness harness("materialclone specular=0 size=0.8", frame_caps(), frame_caps());
  // Metas are registered by the plugin that makes them.
  gst_object_unref(gst_element_factory_make("limematerial", nullptr));
  GstElement* clone = harness.find("materialclone");
  const auto push_map = [&](const std::vector<float>& rgb, guint width, guint height) {
    GstBuffer* buffer = gst_buffer_new_memdup(gray().data(), gray().size());
    auto* meta = reinterpret_cast<GstMaterialMeta*>(
        gst_buffer_add_meta(buffer, gst_meta_get_info("GstMaterialMeta"), nullptr));
    meta->environment_width = width;
    meta->environment_height = height;
    meta->environment = g_bytes_new(rgb.data(), rgb.size() * sizeof(float));
    GST_BUFFER_PTS(buffer) = 0;
    EXPECT_EQ(gst_harness_push(harness.harness(), buffer), GST_FLOW_OK);
    return harness.pull();
  };
  const auto push = [&](float value) {
    return push_map(std::vector<float>(size_t{3} * 32 * 16, value), 32, 16);
  };
  const auto dim = push(.1F), bright = push(1);
  EXPECT_EQ(stat<std::string>(clone, "light"), "estimate");
  EXPECT_GT(at(bright, 48, 48)[0], at(dim, 48, 48)[0] + 50);
  EXPECT_EQ(push(NAN), bright) << "the light before stays";
  EXPECT_EQ(push_map({}, 0, 0), bright) << "empty maps are none";
  harness.set_src_caps(frame_caps(64, 48));
  harness.process(gray(64, 48));
  EXPECT_EQ(stat<std::string>(clone, "light"), "estimate") << "also in frames of another size";
  harness.flush();
  harness.process(gray(64, 48));
  EXPECT_EQ(stat<std::string>(clone, "light"), "estimate") << "and after a seek";
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(CloneTest, StillObjectsAreDrawnOnceAndSpinningOnesTurn) {
  VideoHarness harness("materialclone", frame_caps(), frame_caps());
  GstElement* clone = harness.find("materialclone");
  for (int i = 0; i < 5; ++i) harness.process(gray());
  EXPECT_EQ(stat<guint64>(clone, "drawn"), 1u);
  g_object_set(clone, "spin", 90.0F, nullptr);
  for (int i = 0; i < 5; ++i) harness.process(gray());
  EXPECT_EQ(stat<guint64>(clone, "drawn"), 6u);
  EXPECT_EQ(stat<guint64>(clone, "shadows"), 1u);
}

TEST_F(CloneTest, EveryPropertyMayChangeWhilePlaying) {
  VideoHarness harness("materialclone tuning=shadow=1 mesh=" + written("wedge.obj", kWedge),
                       frame_caps(), frame_caps());
  GstElement* clone = harness.find("materialclone");
  auto before = harness.process(gray());
  for (const char* entries :
       {"shadow=1:elevation=45", "shadow=1:elevation=45:shadow-softness=1", "shadow=0",
        "shadow=0:pitch=30", "shadow=0:roll=30", "shadow=0:environment-rotation=90"}) {
    g_object_set(clone, "tuning", entries, nullptr);
    const auto after = harness.process(gray());
    EXPECT_GT(largest_difference(after, before), 2) << entries;
    before = after;
  }
  const std::pair<const char*, double> changes[] = {
      {"x", .3},       {"y", .3},        {"size", .4},   {"yaw", 40},
      {"specular", 1}, {"shininess", 8}, {"exposure", 1}};
  for (const auto& [name, value] : changes) {
    g_object_set(clone, name, value, nullptr);
    const auto after = harness.process(gray());
    EXPECT_GT(largest_difference(after, before), 2) << name;
    before = after;
  }
  g_object_set(clone, "diffuse-color", 0xff00ff00u, nullptr);
  EXPECT_GT(largest_difference(harness.process(gray()), before), 2);
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(CloneTest, SmallChangesOfPropertiesAreDrawn) {
  VideoHarness harness(
      "materialclone source=properties diffuse-color=0xff000000 specular=0 "
      "exposure=4",
      frame_caps(), frame_caps());
  GstElement* clone = harness.find("materialclone");
  EXPECT_EQ(at(harness.process(gray()), 48, 48)[1], 0);
  g_object_set(clone, "diffuse-color", 0xff000100u, nullptr);
  EXPECT_GT(at(harness.process(gray()), 48, 48)[1], 2);
}

TEST_F(CloneTest, FollowsTheMouseIfEnabled) {
  VideoHarness harness("materialclone size=0.3 tuning=shadow=0 specular=0 diffuse-color=0xff0000ff",
                       frame_caps(), frame_caps());
  GstElement* clone = harness.find("materialclone");
  const auto send = [&](GstEvent* event) { harness.send_upstream(event); };
  auto out = harness.process(gray());
  send(gst_navigation_event_new_mouse_button_press(1, 20, 24, GST_NAVIGATION_MODIFIER_NONE));
  EXPECT_EQ(harness.process(gray()), out) << "not without drag";
  g_object_set(clone, "drag", TRUE, nullptr);
  int notified = 0;
  g_signal_connect(clone, "notify::x",
                   G_CALLBACK(+[](GstElement*, GParamSpec*, int* count) { ++*count; }), &notified);
  send(gst_navigation_event_new_mouse_button_press(1, 20, 24, GST_NAVIGATION_MODIFIER_NONE));
  out = harness.process(gray());
  EXPECT_LT(at(out, 20, 24)[0], 30);
  EXPECT_EQ(at(out, 48, 48)[0], 128);
  send(gst_navigation_event_new_mouse_move(72, 60, GST_NAVIGATION_MODIFIER_NONE));
  out = harness.process(gray());
  EXPECT_LT(at(out, 72, 60)[0], 30);
  EXPECT_NEAR(property<gfloat>(clone, "x"), .75, 1e-6);
  EXPECT_EQ(notified, 2) << "what is bound to x follows";
  send(gst_navigation_event_new_mouse_button_release(1, 70, 60, GST_NAVIGATION_MODIFIER_NONE));
  send(gst_navigation_event_new_mouse_move(10, 10, GST_NAVIGATION_MODIFIER_NONE));
  send(gst_navigation_event_new_mouse_button_press(3, 10, 10, GST_NAVIGATION_MODIFIER_NONE));
  send(gst_navigation_event_new_mouse_button_press(1, NAN, 1e300, GST_NAVIGATION_MODIFIER_NONE));
  out = harness.process(gray());
  EXPECT_EQ(at(out, 10, 10)[0], 128);
}

TEST_F(CloneTest, SizesFormatsAndNewCaps) {
  VideoHarness harness("materialclone spin=40", frame_caps());
  for (const auto& [width, height] : {std::pair{16, 16}, {1, 1}, {200, 120}, {33, 7}, {640, 16}}) {
    harness.set_src_caps(frame_caps(width, height));
    harness.process(gray(width, height), 3);
    harness.flush();
  }
  for (const char* format : {"I420", "NV12", "BGRx", "RGB", "GRAY8", "P010_10LE", "RGBA64_LE"}) {
    harness.set_src_caps(frame_caps(64, 48, format));
    ASSERT_FALSE(harness.process(random_frame(frame_caps(64, 48, format), 1)).empty()) << format;
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(CloneTest, SaturatedAndBlackFramesAreFrames) {
  VideoHarness harness("materialclone x=0 y=1.2 size=2 exposure=10", frame_caps(), frame_caps());
  for (const uint8_t value : {0, 255})
    ASSERT_FALSE(harness.process(flat_frame(frame_caps(), value)).empty());
}

TEST_F(CloneTest, AFrameOf8k) {
  const auto result = run_line(
      "videotestsrc num-buffers=2 pattern=smpte ! video/x-raw,format=I420,width=3840,height=2160 ! "
      "materialclone size=1.2 ! fakesink");
  EXPECT_TRUE(result.eos) << result.first_error();
  // Whether a plane of so many pixels fits is the device's to say: frames, or an error that says
  // so.
  const auto large = run_line(
      "videotestsrc num-buffers=1 pattern=smpte ! video/x-raw,format=I420,width=7680,height=4320 ! "
      "materialclone size=1.2 ! fakesink",
      120);
  const std::string error = large.first_error();
  EXPECT_TRUE(large.eos || error.find("maxStorageBufferRange") != std::string::npos ||
              error.find("maxTexelBufferElements") != std::string::npos)
      << error;
}

TEST_F(CloneTest, ASecondRunIsAsTheFirst) {
  const auto runs = run_line_again(
      "videotestsrc num-buffers=4 pattern=gradient ! video/x-raw,format=RGBA,width=96,height=96 ! "
      "materialclone spin=300 mesh=" +
          written("wedge.obj", kWedge) + " ! appsink name=out",
      3, {});
  for (const LineResult& run : runs) {
    EXPECT_TRUE(run.eos) << run.first_error();
    ASSERT_EQ(run.frames.size(), 4u);
    EXPECT_EQ(run.frames, runs[0].frames);
    EXPECT_EQ(run.warnings.size(), 1u) << "without a material each start warns";
  }
  EXPECT_NE(runs[0].frames[0], runs[0].frames[3]);
}

TEST_F(CloneTest, SpinWithoutTimeIsWarnedOf) {
  const auto result = run_line(
      "appsrc name=in format=bytes caps=video/x-raw,format=RGBA,width=16,height=16,framerate=0/1 ! "
      "materialclone spin=90 source=properties ! fakesink",
      60, [](GstElement* pipeline) {
        GstElement* in = find_element(pipeline, "in");
        for (int i = 0; i < 3; ++i)
          gst_app_src_push_buffer(GST_APP_SRC(in), gst_buffer_new_allocate(nullptr, 1024, nullptr));
        gst_app_src_end_of_stream(GST_APP_SRC(in));
      });
  EXPECT_TRUE(result.eos) << result.first_error();
  expect_one(result.warnings, "stream time");
}

TEST_F(CloneTest, BadFilesAreErrorsWithTheirCause) {
  const auto error = [](const std::string& properties) { return run(properties).first_error(); };
  expect_contains(error("mesh=/nowhere/a.obj"), "mesh /nowhere/a.obj cannot be read");
  expect_contains(error("environment-location=/nowhere/a.hdr"), "/nowhere/a.hdr cannot be read");
  const std::string pipe = folder_ / "pipe.hdr";  // waits for a writer
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_contains(error("environment-location=" + pipe), "pipe.hdr is no file");
  const std::string empty = written("empty.ply", "");
  expect_contains(error("mesh=" + empty), empty);
  const std::string good = written("good.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(error("mesh=" + good), "");
}

TEST_F(CloneTest, AMeshWithDamagedFacesIsDrawnWithOneWarning) {
  const std::string mesh = written("damaged.obj",
                                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\n"
                                   "f 1 2 3\nf 1 2 4\n");
  const auto result = run("source=properties mesh=" + mesh);
  EXPECT_TRUE(result.eos) << result.first_error();
  expect_one(result.warnings, "1 of 2 faces were dropped");
}

TEST_F(CloneTest, FilesAreReadAtEveryStartAndNotBetween) {
  const std::string lamp = lamp_file(8, 8, 2);
  const std::string mesh = written("changing.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string line = "materialclone mesh=" + mesh + " environment-location=" + lamp;
  VideoHarness harness(line, frame_caps());
  harness.process(gray());
  GstElement* other = gst_parse_launch(line.c_str(), nullptr);
  EXPECT_EQ(gst_element_set_state(other, GST_STATE_PAUSED), GST_STATE_CHANGE_SUCCESS);
  gst_element_set_state(other, GST_STATE_READY);
  written("changing.obj", "");
  EXPECT_EQ(gst_element_set_state(other, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  gst_element_set_state(other, GST_STATE_NULL);
  gst_object_unref(other);
  std::filesystem::remove(mesh);
  std::filesystem::remove(lamp);
  harness.set_src_caps(frame_caps(64, 48));
  ASSERT_FALSE(harness.process(gray(64, 48)).empty()) << "new caps read no file";
  EXPECT_EQ(stat<std::string>(harness.find("materialclone"), "light"), "file");
  EXPECT_EQ(stat<guint64>(harness.find("materialclone"), "triangles"), 1u);
}

TEST_F(CloneTest, ALargeMeshIsAWarningOfSoftwareDevices) {
  const auto warnings = [this](uint32_t triangles) {
    std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";
    for (uint32_t i = 0; i < triangles; ++i) obj += "f 1//1 2//1 3//1\n";
    const std::string mesh = written("large.obj", obj);
    VideoHarness harness("materialclone source=properties size=0.1 mesh=" + mesh, frame_caps());
    std::filesystem::remove(mesh);
    EXPECT_EQ(harness.process(gray(), 2).size(), gray().size());
    harness.set_src_caps(frame_caps(64, 48));
    EXPECT_EQ(harness.process(gray(64, 48)).size(), gray(64, 48).size());
    return harness.warnings();
  };
  EXPECT_TRUE(warnings(100'000).empty());
  const auto found = warnings(100'001);
  ASSERT_EQ(found.size(), gpu::Device::open()->is_cpu() ? 1u : 0u);
  if (found.empty()) return;
  expect_contains(found.front(), "100001 triangles");
}

TEST_F(CloneTest, ClonesFromTheClip) {
  const auto result = run_line("filesrc location=" + std::string(MEDIA) +
                               "/clip.webm ! matroskademux ! vp8dec ! identity eos-after=6 ! " +
                               line("show=input estimate-light=true") +
                               " ! materialclone size=0.3 x=0.8 y=0.8 spin=30 ! "
                               "video/x-raw,format=I420 ! appsink name=out");
  EXPECT_TRUE(result.eos) << result.first_error();
  EXPECT_GE(result.frames.size(), 5u);
}

TEST_F(CloneTest, WorksBesideTheElementsOfTheOtherPlugin) {
  for (const std::string order : {"materialclone ! intrinsicdecomp ! intrinsiccompose",
                                  "intrinsicdecomp ! intrinsiccompose ! materialclone"}) {
    const auto result = run_line("videotestsrc num-buffers=3 ! video/x-raw,width=96,height=64 ! " +
                                 order + " ! video/x-raw,format=I420 ! appsink name=out");
    EXPECT_TRUE(result.eos) << result.first_error();
    EXPECT_EQ(result.frames.size(), 3u);
  }
}

}  // namespace inverse::testing
