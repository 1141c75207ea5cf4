// SPDX-License-Identifier: LGPL-2.1-or-later
// Lines that begin with a file or a pattern: playbin, test-pattern, rgbd, clone.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "pipeline_test.hpp"
#include "tests/has_networks.hpp"
#include "tests/kernels/environment/normal_map_file.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kVideo =
    "videotestsrc num-buffers=12 ! video/x-raw,width=160,height=120,framerate=12/1 ! "
    "vp8enc deadline=1 ! queue ! mux. ";
constexpr const char* kSound =
    "audiotestsrc num-buffers=24 samplesperbuffer=2000 ! "
    "audio/x-raw,rate=48000,channels=2 ! audioconvert ! vorbisenc ! queue ! mux. ";

/// One second of video with sound.
void make_clip(const std::string& path) {
  make_media(path, kVideo + std::string(kSound) + "matroskamux name=mux");
}

void make_silent_clip(const std::string& path) {
  make_media(path, kVideo + std::string("matroskamux name=mux"));
}

/// A glossy blue ball before a checkered wall, for half a second; its highlight is up left.
void make_ball(const std::string& folder, const std::string& path) {
  constexpr int kSide = 192, kRadius = 55;
  constexpr double kAlbedo[3] = {.08, .35, .5};
  std::string pixels;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double nx = (x - 80.) / kRadius, ny = (y - 96.) / kRadius, r2 = nx * nx + ny * ny;
      for (const double albedo : kAlbedo) {
        double light = (x / 18 + y / 18) % 2 ? .26 : .18;
        if (r2 < 1) {
          const double nz = std::sqrt(1 - r2), facing = -.48 * nx - .48 * ny + .73 * nz;
          const double half = -.26 * nx - .26 * ny + .93 * nz;
          light =
              albedo * (.25 + .9 * std::max(0., facing)) + .8 * std::pow(std::max(0., half), 60);
        }
        pixels +=
            static_cast<char>(std::lround(255 * std::pow(std::clamp(light, 0., 1.), 1 / 2.2)));
      }
    }
  const std::string raw = folder + "/ball.rgb";
  std::ofstream(raw, std::ios::binary) << pixels;
  make_media(path, "filesrc location=" + raw +
                       " ! rawvideoparse width=192 height=192 format=rgb framerate=24/1 ! "
                       "imagefreeze num-buffers=12 ! videoconvert ! vp8enc deadline=1 cq-level=8 "
                       "end-usage=cq target-bitrate=8000000 ! matroskamux");
}

class Files : public PipelineTest {};

TEST_F(Files, Playbin) {
  make_clip(file("in.mkv"));
  ASSERT_EQ(run("playbin", {file("in.mkv"), "reflectance"}, {{"SINK", raw_file(file("out.mkv"))}}),
            0)
      << output_;
  const Media in = read_media(file("in.mkv")), out = read_media(file("out.mkv"));
  ASSERT_NO_FATAL_FAILURE(expect_video(out, 160, 120, 3));
  // The filter was in: the picture is not the input's.
  EXPECT_GT(std::abs(out.frames[0].mean(1) - in.frames[0].mean(1)), 1);
}

TEST_F(Files, PlaybinWithEditors) {
  make_silent_clip(file("in.mkv"));  // bars; the sixth is red
  const auto play = [&](const std::string& filter) {
    EXPECT_EQ(run("playbin", {file("in.mkv"), filter}, {{"SINK", raw_file(file("out.mkv"))}}), 0)
        << output_;
    return read_media(file("out.mkv"));
  };
  const Media recolored = play(
      "intrinsicdecomp ! intrinsicrecolor key=0xffc00000 target=0xff2040c0 tolerance=0.9 ! "
      "intrinsiccompose");
  ASSERT_NO_FATAL_FAILURE(expect_video(recolored, 160, 120, 3));
  const Image& blue = recolored.frames.back();
  EXPECT_GT(blue.mean(2, .74, .1, .83, .5), blue.mean(0, .74, .1, .83, .5) + 60) << "still red";
  EXPECT_LT(blue.mean(2, .17, .1, .26, .5), blue.mean(0, .17, .1, .26, .5) - 60) << "not yellow";

  const Media same = play("intrinsicedit layer=shading effect=\"identity silent=true\"");
  const Media darker = play("intrinsicedit layer=shading effect=\"videobalance brightness=-0.3\"");
  ASSERT_NO_FATAL_FAILURE(expect_video(same, 160, 120, 3));
  ASSERT_NO_FATAL_FAILURE(expect_video(darker, 160, 120, 3));
  EXPECT_LT(darker.frames.back().mean(1), same.frames.back().mean(1) - 10);
}

TEST_F(Files, HighlightsOfAFile) {
  if (!has_networks()) GTEST_SKIP() << "built without inverse-onnx-import";
  make_ball(file(""), file("in.mkv"));
  ASSERT_EQ(run("run",
                {"--out", file("out"), file("in.mkv"), "--", "limematerial", "show=specular", "!",
                 "videoconvert"},
                {{"INVERSE_RUN", INVERSE_RUN}}),
            0)
      << output_;
  const Media out = read_media(file("out/decomposition.mkv"));
  ASSERT_EQ(out.frames.size(), 12u);
  const Image& last = out.frames.back();
  EXPECT_GT(last.mean(0, .32, .40, .36, .44), 120) << "where the highlight is";
  EXPECT_LT(last.mean(0, .50, .60, .60, .70), 90) << "where none is";
  EXPECT_LT(last.mean(0, .80, .10, .95, .90), 20) << "the wall";
}

TEST_F(Files, CloneDrawsAnObjectOfTheMaterialThatIsSeen) {
  if (!has_networks()) GTEST_SKIP() << "built without inverse-onnx-import";
  if (!has_element("materialclone")) GTEST_SKIP() << "built without Assimp or OpenEXR";
  make_ball(file(""), file("in.mkv"));
  ASSERT_EQ(run("clone", {file("in.mkv")}, {{"SINK", raw_file(file("out.mkv"))}}), 0) << output_;
  EXPECT_EQ(output_.find("WARNING"), std::string::npos) << output_;
  const Media in = read_media(file("in.mkv")), out = read_media(file("out.mkv"));
  ASSERT_NO_FATAL_FAILURE(expect_video(out, 192, 192, 12));
  const Image &before = in.frames.back(), &after = out.frames.back();
  const auto wall = [](const Image& image) { return image.mean(2, .72, .60, .92, .80); };
  EXPECT_GT(std::abs(wall(after) - wall(before)), 30) << "the other object";
  EXPECT_GT(after.mean(2, .72, .60, .92, .80), after.mean(0, .72, .60, .92, .80) + 20) << "is blue";
  EXPECT_NEAR(after.mean(2, .2, .3, .6, .7), before.mean(2, .2, .3, .6, .7), 2) << "as the first";
}

TEST_F(Files, CloneReportsWhatIsMissing) {
  if (!has_element("materialclone")) GTEST_SKIP() << "built without Assimp or OpenEXR";
  expect_failure("clone", {"/dev/video97"}, "there is no camera /dev/video97",
                 {{"SINK", "fakesink"}});
  make_silent_clip(file("in.mkv"));
  EXPECT_EQ(run("clone", {file("in.mkv"), file("none.obj")}, {{"SINK", "fakesink"}}), 1);
  expect_contains(output_, "there is no mesh");
}

TEST_F(Files, RgbdWritesReflectance) {
  const auto frames_of = [&](const char* memory) {
    EXPECT_EQ(run("rgbd", {},
                  {{"MEMORY", memory},
                   {"SOURCE",
                    "rgbdtestsrc is-live=false samples=1 num-buffers=6 ! "
                    "video/x-raw,width=96,height=72"},
                   {"SINK", raw_file(file("out.mkv"))}}),
              0)
        << output_;
    return read_media(file("out.mkv")).frames;
  };
  const auto with = frames_of("true"), without = frames_of("false");
  ASSERT_FALSE(with.empty());
  ASSERT_FALSE(without.empty());
  const auto mean = [](const auto& frame) { return frame.mean(1, 0, 0, 1, 1); };
  EXPECT_GT(mean(with.back()), 60);
  EXPECT_NEAR(mean(with.back()), mean(without.back()), 12);
}

TEST_F(Files, RgbdPlaysARecording) {
  std::vector<uint8_t> color, depth;
  for (uint32_t i = 0; i < 96 * 72; ++i) {
    color.insert(color.end(), {static_cast<uint8_t>(i % 96 < 48 ? 200 : 60), 120, 90});
    depth.insert(depth.end(), {1500 >> 8, 1500 & 255});
  }
  for (const auto& [kind, channels, bits, bytes] :
       {std::tuple{"color", 3U, 8U, &color}, {"depth", 1U, 16U, &depth}}) {
    std::filesystem::create_directories(file(std::string("a recording/") + kind));
    for (int n = 0; n < 4; ++n) {
      const auto picture = png(96, 72, channels, bits, *bytes);
      std::ofstream(file("a recording/") + kind + "/" + std::to_string(n) + ".png",
                    std::ios::binary)
          .write(reinterpret_cast<const char*>(picture.data()),
                 static_cast<std::streamsize>(picture.size()));
    }
  }
  ASSERT_EQ(
      run("rgbd", {file("a recording")}, {{"LIVE", "false"}, {"SINK", raw_file(file("out.mkv"))}}),
      0)
      << output_;
  EXPECT_EQ(output_.find("WARNING"), std::string::npos) << output_;
  const auto frames = read_media(file("out.mkv")).frames;
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_GT(frames[3].mean(0, .1, .1, .4, .9), frames[3].mean(0, .6, .1, .9, .9) + 50);
  expect_failure("rgbd", {"/nowhere/at/all"}, "there is no folder", {{"SINK", "fakesink"}});
}

TEST_F(Files, TestPatternTurnsRedBarsGreen) {
  ASSERT_EQ(run("test-pattern", {},
                {{"SOURCE",
                  "videotestsrc num-buffers=5 ! "
                  "video/x-raw,format=RGBA,width=320,height=240,framerate=25/1"},
                 {"SINK", raw_file(file("out.mkv"))}}),
            0)
      << output_;
  const Media media = read_media(file("out.mkv"));
  ASSERT_NO_FATAL_FAILURE(expect_video(media, 320, 240, 1));
  // The upper bars of smpte: white, yellow, cyan, green, magenta, red, blue.
  const auto bar = [&](int index, int channel) {
    return media.frames.back().mean(channel, (index + .3) / 7, .1, (index + .7) / 7, .5);
  };
  EXPECT_LT(bar(5, 0), 80) << "still red";
  EXPECT_GT(bar(5, 1), 100) << "not green";
  EXPECT_GT(bar(1, 0), 150) << "yellow was touched";
  EXPECT_GT(bar(6, 2), 150) << "blue was touched";
}

}  // namespace
}  // namespace inverse::testing
