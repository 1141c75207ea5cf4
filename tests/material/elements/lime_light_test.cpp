// SPDX-License-Identifier: LGPL-2.1-or-later
// The light around limematerial's object: who gets it, the file it goes to, normals, the preview.
#include <sys/stat.h>

#include <algorithm>
#include <optional>

#include "gst/inverse/inverse_material_meta.h"
#include "kernels/environment/environment.hpp"
#include "lime_fixture.hpp"
#include "tests/kernels/environment/normal_map_file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/update_max.hpp"

namespace inverse::testing {
namespace {

class LimeLight : public LimeElementTest {
 protected:
  /// The light of the last of some frames; empty if there is none.
  std::vector<float> light(const std::string& more, int frames = 8) {
    VideoHarness harness(line(more), caps(), caps());
    std::vector<float> result;
    for (int i = 0; i < frames; ++i) {
      const Buffer out = harness.process_buffer(scene(60, 30, 20));
      const GstMaterialMeta* meta = gst_buffer_get_material_meta(out.get());
      result = floats_of(meta->environment);
      EXPECT_EQ(result.size(), meta->environment
                                   ? 3 * meta->environment_width * meta->environment_height
                                   : meta->environment_width);
    }
    return result;
  }
  /// A source of pictures with a red disc.
  static std::string ball() {
    return "videotestsrc num-buffers=8 pattern=solid-color foreground-color=0xffe66464 ! "
           "video/x-raw,format=RGBA,width=48,height=48 ! videobox border-alpha=1 top=-8 left=-24 "
           "right=-24 bottom=-8 fill=blue ! ";
  }
};

}  // namespace

TEST_F(LimeLight, IsInTheMetaOnRequest) {
  EXPECT_TRUE(light("").empty()) << "nobody asked";
  const auto requested = light("estimate-light=true");
  ASSERT_FALSE(requested.empty());
  for (const float v : requested) ASSERT_TRUE(v >= 0 && std::isfinite(v));
  EXPECT_GT(*std::max_element(requested.begin(), requested.end()), .01);
  EXPECT_EQ(light("show=preview"), requested);
  EXPECT_TRUE(light("estimate-light=true normals=none").empty());
}

TEST_F(LimeLight, NormalMapsChangeTheLight) {
  const NormalMapPath file;
  file.write(png(1, 1, 3, 8, {128, 218, 218}));
  const auto upward = light("estimate-light=true normals=none normal-map=" + file.path());
  ASSERT_FALSE(upward.empty());
  EXPECT_NE(upward, light("estimate-light=true"));
  expect_contains(run("normal-map=/nowhere.png").first_error(), "/nowhere.png");
}

TEST_F(LimeLight, UnusableNormalMapsAreRefused) {
  const auto error_of = [this](const std::string& path) {
    return run("normal-map=" + path).first_error();
  };
  const NormalMapPath away;
  away.write(png(1, 1, 3, 8, {128, 128, 0}));
  expect_contains(error_of(away.path()), "faces the camera");
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe.png";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expect_contains(error_of(pipe), "is no file");  // it would wait for ever
}

TEST_F(LimeLight, NormalMapsThatHelpLittleGetAWarning) {
  const auto warnings_of = [this](const std::vector<uint8_t>& pixels, int left) {
    const NormalMapPath file;
    file.write(png(2, 1, 3, 8, pixels));
    VideoHarness harness(line("estimate-light=true normal-map=" + file.path()), caps(), caps());
    for (int i = 0; i < 8; ++i) harness.process(scene(left, 30, 10));
    return harness.warnings();
  };
  const std::vector<uint8_t> left_alone{128, 218, 218, 0, 0, 0};
  EXPECT_TRUE(warnings_of(left_alone, 14).empty());
  expect_one(warnings_of(left_alone, 84), "normals.png has no normals where the object is");
  const auto gray = warnings_of({200, 200, 200, 200, 200, 200}, 14);  // of length .98
  EXPECT_TRUE(gray.empty());
  expect_one(warnings_of({180, 180, 180, 180, 180, 180}, 14), "0 % have a length near 1");
}

TEST_F(LimeLight, TheFileIsTheOneThatWasNamedAtTheStart) {
  const TemporaryFolder folder;
  {
    VideoHarness harness(line("save-environment-location=" + (folder / "first.hdr")), caps(),
                         caps());
    harness.process(scene(60, 30, 20));
    g_object_set(harness.find("limematerial"), "save-environment-location",
                 (folder / "second.hdr").c_str(), nullptr);
    for (int i = 0; i < 6; ++i) harness.process(scene(60, 30, 20));
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "first.hdr"));
  EXPECT_FALSE(std::filesystem::exists(folder / "second.hdr"));
}

TEST_F(LimeLight, FilesAreReadAtTheStartAlone) {
  GstElement* lime = gst_element_factory_make("limematerial", nullptr);
  g_object_set(lime, "models", "/nowhere", nullptr);
  EXPECT_EQ(gst_element_set_state(lime, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  g_object_set(lime, "models", files.folder().c_str(), "normal-map", "/nowhere.png", nullptr);
  EXPECT_EQ(gst_element_set_state(lime, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
  gst_element_set_state(lime, GST_STATE_NULL);
  gst_object_unref(lime);

  std::optional<NormalMapPath> file(std::in_place);
  file->write(png(1, 1, 3, 8, {128, 218, 218}));
  VideoHarness harness(line("estimate-light=true normals=none normal-map=" + file->path()), caps());
  file.reset();
  for (const auto& [width, height] : {std::pair{96, 64}, {64, 96}}) {
    harness.set_src_caps(caps(width, height));
    harness.process(scene(width / 2, height / 2, 20, width, height), 8);
    EXPECT_GT(stat<guint64>(harness.find("limematerial"), "light-views"), 0u);
  }
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(LimeLight, GoesToAFileWhenTheStreamEnds) {
  const TemporaryFolder folder;
  const std::string file = folder / "light.hdr";
  const auto result = run_line(ball() + line("save-environment-location=" + file) + " ! fakesink");
  EXPECT_TRUE(result.eos) << result.first_error();
  EXPECT_TRUE(result.warnings.empty()) << result.warnings.front();
  const Environment light = Environment::load(file);
  EXPECT_GT(*std::max_element(light.rgb().begin(), light.rgb().end()), .01);
}

TEST_F(LimeLight, GoesToAFileWhenTheElementStops) {
  const TemporaryFolder folder;
  const std::string file = folder / "light.hdr";
  {
    VideoHarness harness(line("save-environment-location=" + file), caps(), caps());
    for (int i = 0; i < 6; ++i) harness.process(scene(60, 30, 20));
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST_F(LimeLight, AFileThatCannotBeWrittenIsAnErrorAtTheStartAndAWarningAtTheEnd) {
  const auto refused =
      run_line(ball() + line("save-environment-location=/nowhere/light.hdr") + " ! fakesink");
  expect_contains(refused.first_error(), "/nowhere/light.hdr");
  const TemporaryFolder here;
  const std::string pipe = here / "pipe.hdr";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const auto& [path, why] :
       {std::pair{pipe, "it is a pipe"},
        {here.path(), "it is a folder"},
        {here / "light.exr", "it would be a Radiance picture; name it .hdr"}}) {
    const auto error =
        run_line(ball() + line("save-environment-location=" + path) + " ! fakesink").first_error();
    expect_contains(error, path + " cannot be written: " + why);
  }
  std::optional<TemporaryFolder> gone(std::in_place);
  VideoHarness harness(line("save-environment-location=" + (*gone / "light.hdr")), caps(), caps());
  for (int i = 0; i < 6; ++i) harness.process(scene(60, 30, 20));
  gone.reset();
  gst_harness_push_event(harness.harness(), gst_event_new_eos());
  expect_one(harness.warnings(), "light.hdr");
  const TemporaryFolder folder;
  const std::string file = folder / "light.hdr";
  const auto unknown = run_line("videotestsrc num-buffers=3 pattern=black ! " +
                                line("save-environment-location=" + file) + " ! fakesink");
  EXPECT_TRUE(unknown.eos);
  expect_one(unknown.warnings, "there is no light yet");
  EXPECT_EQ(unknown.warnings.at(0).find("estimate-light=true"), std::string::npos)
      << "save-environment-location asks for the light itself";
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(LimeLight, ARunWithoutFramesPostsNoWarning) {
  const TemporaryFolder folder;
  VideoHarness harness(line(), caps(), caps());
  GstElement* lime = harness.find("limematerial");
  harness.process(scene(60, 30, 20));
  gst_element_set_state(lime, GST_STATE_READY);
  g_object_set(lime, "save-environment-location", (folder / "light.hdr").c_str(), nullptr);
  for (const GstState state : {GST_STATE_PAUSED, GST_STATE_READY})
    EXPECT_EQ(gst_element_set_state(lime, state), GST_STATE_CHANGE_SUCCESS);
  EXPECT_TRUE(harness.warnings().empty());
}

TEST_F(LimeLight, IsSavedOnRequest) {
  VideoHarness harness(line("estimate-light=true"), caps(), caps());
  GstElement* lime = harness.find("limematerial");
  const auto save = [lime](const char* path) {
    gboolean good = TRUE;
    g_signal_emit_by_name(lime, "save-environment", path, &good);
    return good;
  };
  const TemporaryFolder folder;
  const std::string file = folder / "light.hdr";
  EXPECT_FALSE(save(file.c_str())) << "nothing is known yet";
  for (int i = 0; i < 6; ++i) harness.process(scene(60, 30, 20));
  EXPECT_FALSE(save(nullptr));
  EXPECT_FALSE(save("/nowhere/light.hdr"));
  EXPECT_TRUE(save(file.c_str()));
  EXPECT_TRUE(std::filesystem::exists(file));
  std::filesystem::remove(file);
  harness.flush();
  harness.process(scene(0, 0, 0));
  harness.set_src_caps(VideoHarness::caps("RGBA", 64, 64));
  EXPECT_TRUE(save(file.c_str())) << "the last that was known";
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST_F(LimeLight, PreviewShowsTheEstimatedMaterial) {
  VideoHarness harness(line("show=preview preview-size=0.5"), caps(), caps());
  const auto none = scene(0, 0, 0), frame = scene(30, 30, 20);
  EXPECT_EQ(harness.process(none), none) << "no object, no sphere";
  const auto out = harness.process(frame, 8);
  size_t changed = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const size_t at = 4 * (size_t{kWidth} * y + x);
      int largest = 0;
      for (size_t c = 0; c < 4; ++c) update_max(largest, std::abs(out[at + c] - frame[at + c]));
      const bool corner = x >= kWidth - 35 && y >= kHeight - 35;
      if (!corner) {
        ASSERT_EQ(largest, 0) << x << ", " << y;
      }
      changed += largest > 2;
    }
  EXPECT_GT(changed, 500u);
  EXPECT_TRUE(harness.errors().empty());
}

TEST_F(LimeLight, EndsWithItsSceneOrItsRequest) {
  VideoHarness harness(line("show=input estimate-light=true"), caps());
  GstElement* lime = harness.find("limematerial");
  const auto lit = [&](const std::vector<uint8_t>& frame) {
    const Buffer buffer = harness.process_buffer(frame);
    return buffer && gst_buffer_get_material_meta(buffer.get())->environment;
  };
  const auto ball = scene(60, 30, 20);
  for (int i = 0; i < 6; ++i) lit(ball);
  EXPECT_TRUE(lit(ball));
  g_object_set(lime, "estimate-light", FALSE, nullptr);
  EXPECT_FALSE(lit(ball));
  EXPECT_EQ(stat<guint64>(lime, "light-views"), 0u);
  g_object_set(lime, "estimate-light", TRUE, nullptr);
  EXPECT_FALSE(lit(ball)) << "what was known is old";
  for (int i = 0; i < 6; ++i) lit(ball);
  EXPECT_TRUE(lit(ball));
  gst_util_set_object_arg(G_OBJECT(lime), "normals", "none");
  EXPECT_FALSE(lit(ball));
  gst_util_set_object_arg(G_OBJECT(lime), "normals", "silhouette");
  for (int i = 0; i < 6; ++i) lit(ball);
  EXPECT_TRUE(lit(ball));
  harness.set_src_caps(caps(64, 96));
  EXPECT_FALSE(lit(scene(0, 0, 0, 64, 96)));
}

TEST_F(LimeLight, NoKernelIsBuiltWhenAnotherPictureIsShown) {
  const NewDevice none_built;
  VideoHarness harness(line("show=input"), caps(), caps());
  GstElement* lime = harness.find("limematerial");
  for (int i = 0; i < 6; ++i) harness.process(scene(60, 30, 20));
  const auto before = stat<guint64>(lime, "kernels");
  for (const char* show : {"preview", "mosaic", "mask", "mirror"}) {
    gst_util_set_object_arg(G_OBJECT(lime), "show", show);
    for (int i = 0; i < 2; ++i) harness.process(scene(60, 30, 20));
    EXPECT_EQ(stat<guint64>(lime, "kernels"), before) << show;
  }
}

}  // namespace inverse::testing
