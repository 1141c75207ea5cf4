// SPDX-License-Identifier: LGPL-2.1-or-later
// lightstagesync: captures that are put together, and written.
#include <ImfArray.h>
#include <ImfRgbaFile.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "stage_fixture.hpp"
#include "tests/srgb.hpp"

namespace inverse::testing {
namespace {

class StageCapture : public StageSync {
 protected:
  void SetUp() override {
    StageSync::SetUp();
    use(static_capture(stage_lights(geodesic_directions(42))));
    gst_util_set_object_arg(G_OBJECT(element_), "assemble", "olat");
  }
};

TEST_F(StageCapture, LightsAreMovedToTheLastTrackingFrameAndWritten) {
  constexpr int kWide = 160, kHigh = 120;
  const std::string location = folder_ / "capture";
  g_object_set(element_, "location", location.c_str(), nullptr);
  BallOnStage ball(program_, kWide, kHigh);
  ball.set_gain(2);
  start(0, caps(kWide, kHigh));
  // Sways, a pixel a frame at most.
  const auto place = [](int64_t n) { return 9 * std::sin(static_cast<double>(n) / 9); };
  const auto triggers = static_cast<int64_t>(*program_.triggers());
  for (int64_t n = -20; n < triggers; ++n)
    ASSERT_EQ(push(ball.draw(n, place(n)), static_cast<double>(n)), GST_FLOW_OK);
  const auto frames = pull(static_cast<size_t>(triggers));
  int64_t reference = 0;
  for (const Out& frame : frames)
    if (frame.kind == GST_LIGHT_STAGE_TRACKING) reference = frame.trigger;
  double as_seen = 0, moved = 0, lights = 0;
  for (const Out& frame : frames) {
    if (frame.kind != GST_LIGHT_STAGE_OLAT) continue;
    const auto truth = ball.draw(frame.trigger, place(reference));
    as_seen += l1(ball.draw(frame.trigger, place(frame.trigger)), truth);
    moved += l1(frame.bytes, truth);
    ++lights;
  }
  EXPECT_EQ(lights, 42);
  printf(
      "single lights against what they would have been at the last tracking frame, l1 in codes: "
      "%.3f as seen, %.3f moved\n",
      as_seen / lights, moved / lights);
  EXPECT_LT(moved, 0.5 * as_seen);

  std::ifstream file(location + "/camera_0/lights.json");
  const auto list = nlohmann::json::parse(file);
  ASSERT_EQ(list["lights"].size(), 42u);
  EXPECT_EQ(list["width"], kWide);
  EXPECT_NEAR(list["lights"][7]["direction"][1].get<double>(), program_.lights[7].direction[1],
              1e-9);
  for (const char* kind : {"tracking", "gradient-a", "gradient-b"})
    EXPECT_TRUE(std::filesystem::exists(location + "/camera_0/" + list[kind].get<std::string>()));
  const std::string name = location + "/camera_0/" + list["lights"][7]["file"].get<std::string>();
  Imf::RgbaInputFile exr(name.c_str());
  Imf::Array2D<Imf::Rgba> pixels(kHigh, kWide);
  exr.setFrameBuffer(&pixels[0][0], 1, kWide);
  exr.readPixels(0, kHigh - 1);
  for (const Out& frame : frames) {
    if (frame.light != 7) continue;
    double off = 0;
    for (int y = 0; y < kHigh; ++y)
      for (int x = 0; x < kWide; ++x) {
        const double linear =
            srgb_light(frame.bytes[4 * static_cast<size_t>(y * kWide + x)] / 255.0);
        off += std::abs(linear - static_cast<double>(static_cast<float>(pixels[y][x].r)));
      }
    EXPECT_LT(off / (kWide * kHigh), 2e-3);
  }
}

TEST_F(StageCapture, LatencyIncludesTheBufferedPass) {
  start();
  gst_harness_set_upstream_latency(camera(), 20 * GST_MSECOND);
  const GstClockTime period = GST_SECOND / 60 + 1;
  // 3 of the marker, 42 lights, 4 tracking frames, 2 gradients; 23 that labels may wait for.
  EXPECT_EQ(gst_harness_query_latency(camera()), 20 * GST_MSECOND + (51 + 23) * period);
}

TEST_F(StageCapture, ACaptureThatAnotherStreamCutsShortGoesOutBeforeIt) {
  start();
  push_all(-20, 30);
  ASSERT_TRUE(gst_harness_push_event(camera(), gst_event_new_stream_start("another")));
  const auto triggers = static_cast<int64_t>(*program_.triggers());
  push_all(-20, triggers);
  const auto frames = pull(27 + static_cast<size_t>(triggers));
  EXPECT_EQ(frames[26].trigger, 26);
  EXPECT_EQ(frames[27].trigger, 0);
  EXPECT_EQ(frames.back().trigger, triggers - 1);
}

TEST_F(StageCapture, ACaptureThatIsCutShortGoesOutAsFarAsItCame) {
  start();
  push_all(-20, 30);
  ASSERT_TRUE(push_end());
  EXPECT_EQ(pull(27).back().trigger, 26);  // the last tracking frame
  EXPECT_EQ(count("ambiguous"), 3u);
  EXPECT_TRUE(errors().empty());
}

TEST_F(StageCapture, ACaptureWhoseLastFrameIsLostGoesOutWithTheFirstOneAfterIt) {
  start();
  const auto triggers = static_cast<int64_t>(*program_.triggers());
  push_all(-20, triggers - 1);
  push_all(triggers, triggers + 3);
  const auto frames = pull(static_cast<size_t>(triggers) - 1);
  EXPECT_EQ(frames.back().trigger, triggers - 2);
  EXPECT_EQ(frames.back().kind, GST_LIGHT_STAGE_GRADIENT_A);
}

TEST_F(StageCapture, PicturesOfAnEarlierCaptureAreNotAmongTheNewOnes) {
  const std::string location = folder_ / "capture";
  const std::string folder = location + "/camera_0";
  g_object_set(element_, "location", location.c_str(), nullptr);
  std::filesystem::create_directories(folder + "/olat");
  for (const char* name : {"/olat/003.exr", "/olat/999.exr", "/olat/notes.exr", "/tracking.exr"})
    std::ofstream(folder + name) << "of an earlier one";
  start();
  const auto triggers = static_cast<int64_t>(*program_.triggers());
  const auto shows_light_3 = [&](int64_t n) {
    const auto at = program_.at(static_cast<uint64_t>(std::max<int64_t>(n, 0)));
    return program_.kind(at) == StepKind::olat && program_.steps[at.index].light == 3;
  };
  for (int64_t n = -20; n < triggers; ++n)
    if (!shows_light_3(n)) {
      ASSERT_EQ(push(n), GST_FLOW_OK);
    }
  pull(static_cast<size_t>(triggers) - 1);
  for (int i = 0; i < 500 && count("passes") == 0; ++i) g_usleep(10000);  // the list comes last
  EXPECT_FALSE(std::filesystem::exists(folder + "/olat/003.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder + "/olat/999.exr"));
  EXPECT_TRUE(std::filesystem::exists(folder + "/olat/notes.exr"));
  EXPECT_GT(std::filesystem::file_size(folder + "/tracking.exr"), 100u);
  const auto list = nlohmann::json::parse(std::ifstream(folder + "/lights.json"));
  EXPECT_FALSE(list["lights"][3].contains("file"));
  EXPECT_TRUE(list["lights"][4].contains("file"));

  // The test source plays it, without the light that is not there.
  const LineResult played = run_line(
      "lightstagetestsrc is-live=false num-buffers=8 program=static "
      "location=" +
          folder + " ! appsink name=out sync=false",
      60);
  EXPECT_EQ(played.frames.size(), 8u) << played.first_error();
  expect_one(played.warnings, "no picture of light 3");
}

TEST_F(StageCapture, FewFramesMayWaitForCamerasAndManyForTheMarker) {
  g_object_set(element_, "tuning", "max-frames=8", nullptr);
  start();
  push_all(-3, 14);
  push_all(15, 40);  // without the first tracking frame: the second one has to suffice
  ASSERT_TRUE(push_end());
  const auto frames = pull(38);
  EXPECT_EQ(frames.front().trigger, 0);
  EXPECT_EQ(frames.back().trigger, 38);  // a tracking frame
}

TEST_F(StageCapture, AFolderThatCannotBeMadeIsAnError) {
  g_object_set(element_, "location", "/proc/nowhere/capture", nullptr);
  EXPECT_EQ(gst_element_set_state(element_, GST_STATE_PLAYING), GST_STATE_CHANGE_FAILURE);
  gst_element_set_state(element_, GST_STATE_NULL);
  expect_one(errors(), "/proc/nowhere/capture");
}

class StageCaptureFolder : public StageCapture {
 protected:
  void SetUp() override {
    StageCapture::SetUp();
    location_ = folder_ / "capture";
    g_object_set(element_, "location", location_.c_str(), nullptr);
  }
  void use_passes(LightProgram::Marker marker) {
    LightProgram program = static_capture(stage_lights(geodesic_directions(12)));
    program.marker = marker;
    program.repeat = 0;
    use(program);
    pass_ = static_cast<int64_t>(program_.steps.size());
  }
  /// Plays a program from before its start until `last`, to the end of the stream.
  void play(int64_t last) {
    start();
    push_all(-20, last + 1);
    ASSERT_TRUE(push_end());
    ASSERT_TRUE(ends());
  }
  /// Pictures of single lights and others in a folder.
  static size_t pictures(const std::string& folder) {
    size_t found = 0;
    if (!std::filesystem::exists(folder)) return 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder))
      found += file.path().extension() == ".exr" ? 1 : 0;
    return found;
  }
  std::string location_;
  int64_t pass_ = 0;
};

TEST_F(StageCaptureFolder, KeepsACompletePassIfTheStreamEndsInTheNextMarker) {
  use_passes(LightProgram::Marker::pass);
  play(LightProgram::kMarkerSteps + pass_ + 2);
  EXPECT_EQ(pictures(location_ + "/camera_0"), 15u);
  EXPECT_TRUE(std::filesystem::exists(location_ + "/camera_0/lights.json"));
  EXPECT_FALSE(std::filesystem::exists(location_ + "/camera_0.partial"));
  EXPECT_FALSE(std::filesystem::exists(location_ + "/camera_0.new"));
  EXPECT_TRUE(warnings().empty());
}

TEST_F(StageCaptureFolder, APassThatIsCutShortIsPutBesideTheWholeOneBeforeIt) {
  use_passes(LightProgram::Marker::start);
  play(LightProgram::kMarkerSteps + pass_ + 11);  // a tracking frame
  EXPECT_EQ(pictures(location_ + "/camera_0"), 15u);
  const auto list = [&](const char* folder) {
    return nlohmann::json::parse(std::ifstream(location_ + folder + "/lights.json"));
  };
  EXPECT_TRUE(list("/camera_0").contains("gradient-b"));
  EXPECT_FALSE(list("/camera_0.partial").contains("gradient-b"));
  EXPECT_EQ(pictures(location_ + "/camera_0.partial"), 12u);
  EXPECT_FALSE(std::filesystem::exists(location_ + "/camera_0.new"));
  expect_one(warnings(), "cut short: 12 of 15 pictures", "camera_0.partial");
}

TEST_F(StageCaptureFolder, APartialPassAfterAFlushOrNewCapsReplacesNoCompleteOne) {
  use_passes(LightProgram::Marker::start);
  start();
  const int64_t first = LightProgram::kMarkerSteps + pass_, second = first + pass_,
                third = second + pass_;
  push_all(-20, first + 4);
  start(0, caps(kWidth + 16, kHeight));
  const BallOnStage wider(program_, kWidth + 16, kHeight);
  push_all(wider, first + 4, second + 4);
  // The whole one, and both parts of the one that the caps cut.
  for (int i = 0; i < 500 && count("passes") < 3; ++i) g_usleep(10000);
  flush(camera());
  push_all(wider, second + 6, third);
  ASSERT_TRUE(push_end());
  ASSERT_TRUE(ends());
  EXPECT_EQ(pictures(location_ + "/camera_0"), 15u);
  const auto list = nlohmann::json::parse(std::ifstream(location_ + "/camera_0/lights.json"));
  EXPECT_EQ(list["width"], kWidth);
  EXPECT_GT(pictures(location_ + "/camera_0.partial"), 0u);
  EXPECT_FALSE(warnings().empty());
}

TEST_F(StageCaptureFolder, AFolderMayBeALinkToAnotherDisk) {
  use_passes(LightProgram::Marker::pass);
  const TemporaryFolder elsewhere;
  std::filesystem::create_directories(location_);
  std::filesystem::create_directory_symlink(elsewhere.path(), location_ + "/camera_0");
  play(LightProgram::kMarkerSteps + pass_);
  EXPECT_EQ(pictures(elsewhere.path()), 15u);
}

// In a folder that others may write to, links may appear where the pictures will be.
TEST_F(StageCaptureFolder, DraftsDoNotFollowLinks) {
  use_passes(LightProgram::Marker::pass);
  const TemporaryFolder elsewhere;
  const std::string victim = elsewhere.write("victim", "somebody's");
  std::atomic<bool> stop{false};
  std::thread planter([&] {
    const std::string draft = location_ + "/camera_0.new";
    std::error_code none;
    while (!stop) {
      std::filesystem::create_directory_symlink(elsewhere.path(), draft, none);
      for (int light = 0; light < 15; ++light)
        std::filesystem::create_symlink(
            victim, draft + "/olat/0" + (light < 10 ? "0" : "") + std::to_string(light) + ".exr",
            none);
    }
  });
  start();
  for (int64_t n = -20; n < LightProgram::kMarkerSteps + pass_; ++n) push(n);
  push_end();
  ends();  // or an error says what is in the way
  stop = true;
  planter.join();
  EXPECT_FALSE(std::filesystem::exists(elsewhere / "olat"));
  std::string text;
  std::getline(std::ifstream(victim), text);
  EXPECT_TRUE(text == "somebody's");
}

TEST_F(StageCaptureFolder, TheFirstCaptureIsThereAsFarAsItCame) {
  use_passes(LightProgram::Marker::start);
  play(LightProgram::kMarkerSteps + 11);
  EXPECT_EQ(pictures(location_ + "/camera_0"), 12u);
  expect_one(warnings(), "cut short: 12 of 15 pictures");
}

// The launch line of docs/reference/elements/lightstagesync.md, and pairs of what it plays.
TEST(StageRoundTrip, ACaptureIsPlayedAsBrightAsTheSubjectWas) {
  const TemporaryFolder folder;
  const std::string location = folder / "capture";
  const std::string small = " ! video/x-raw,format=RGBA,width=64,height=48";
  const LineResult captured =
      run_line("lightstagetestsrc is-live=false program=static:42 gain=3 num-buffers=70" + small +
                   " ! lightstagesync program=static:42 assemble=olat location=" + location +
                   " ! appsink name=out sync=false",
               120);
  ASSERT_EQ(captured.first_error(), "");
  const std::string played = location + "/camera_0", program = "program=performance:" + played;
  const LineResult pairs =
      run_line("lightstagetestsrc is-live=false num-buffers=40 location=" + played +
                   " ! lightstagesync assemble=pairs " + program +
                   " ! video/x-raw(memory:SystemMemory),format=RGBA ! appsink name=out sync=false",
               120);
  ASSERT_EQ(pairs.first_error(), "");
  EXPECT_TRUE(pairs.warnings.empty()) << pairs.warnings.front();
  ASSERT_GT(pairs.frames.size(), 15u);
  // A and B are half of all lights each: the brightest of the subject is about half of white.
  const auto& frame = pairs.frames.back();
  uint8_t largest = 0;
  for (size_t i = 0; i < frame.size(); i += 4) largest = std::max(largest, frame[i + 1]);
  EXPECT_GT(largest, 150);
  EXPECT_LT(largest, 255);
}

}  // namespace
}  // namespace inverse::testing
