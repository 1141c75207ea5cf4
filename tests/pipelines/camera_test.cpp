// SPDX-License-Identifier: LGPL-2.1-or-later
// Pipelines that begin with a camera. USB and libcamera need hardware: live videotestsrc replaces
// them, in their formats. With INVERSE_TEST_CAMERA=/dev/videoN the webcam's pipeline also runs with
// a real one. The industrial camera is Aravis' software camera.
#include <unistd.h>

#include <chrono>
#include <thread>

#include "pipeline_test.hpp"

namespace inverse::testing {
namespace {

/// What a camera sends: moving, live, `format` is caps or an encoder.
std::string camera(const std::string& format) {
  return "videotestsrc is-live=true pattern=smpte ! " + format;
}

std::string raw(const std::string& format) {
  return "video/x-raw,format=" + format + ",width=320,height=240,framerate=10/1";
}

class Camera : public PipelineTest {
 protected:
  void expect_line(const std::string& script, const Process::Environment& environment) {
    auto all = environment;
    all["SINK"] = raw_file(file("out.mkv"));
    Process line({PipelineTest::script(script)}, PipelineTest::environment(all));
    ASSERT_NO_FATAL_FAILURE(end_when_grown(line, file("out.mkv"), 6 * 320 * 240 * 3 / 2));
    const Media media = read_media(file("out.mkv"));
    ASSERT_NO_FATAL_FAILURE(expect_video(media, 320, 240, 3));
    expect_mosaic(media.frames.back());
  }
};

TEST_F(Camera, WebcamSendsYuy2) { expect_line("webcam", {{"SOURCE", camera(raw("YUY2"))}}); }
TEST_F(Camera, WebcamSendsNv12) { expect_line("webcam", {{"SOURCE", camera(raw("NV12"))}}); }
TEST_F(Camera, WebcamSendsMjpeg) {
  expect_line("webcam", {{"SOURCE", camera(raw("I420") + " ! jpegenc")}});
}
TEST_F(Camera, LibcameraSendsNv12) { expect_line("libcamera", {{"SOURCE", camera(raw("NV12"))}}); }
TEST_F(Camera, LibcameraSendsNv21) { expect_line("libcamera", {{"SOURCE", camera(raw("NV21"))}}); }

TEST_F(Camera, WebcamOfThisMachine) {
  const char* device = getenv("INVERSE_TEST_CAMERA");
  if (!device) GTEST_SKIP() << "INVERSE_TEST_CAMERA names no camera";
  expect_line("webcam", {{"SOURCE", std::string("v4l2src device=") + device +
                                        " ! video/x-raw,width=320,height=240;"
                                        "image/jpeg,width=320,height=240"}});
}

TEST_F(Camera, MissingOnesAreNamed) {
  expect_failure("webcam", {"/dev/video97"}, "there is no camera /dev/video97",
                 {{"SINK", "fakesink"}});
}

/// The real element accepts the script's pipeline and reports its missing camera.
TEST_F(Camera, MissingLibcamera) {
  if (!has_element("libcamerasrc"))
    GTEST_SKIP() << "libcamerasrc is missing: install gstreamer1.0-libcamera";
  EXPECT_NE(run("libcamera", {"no-such-camera"}, {{"SINK", "fakesink"}}), 0);
  expect_contains(output_, "Could not find a camera named 'no-such-camera'");
}

TEST_F(Camera, AMissingDisplayIsReported) {
  expect_failure("webcam", {}, "no display", {{"SOURCE", camera(raw("YUY2"))}});
}

/// The camera in software on loopback.
class Aravis : public PipelineTest {
 protected:
  void SetUp() override {
    if (system("command -v arv-fake-gv-camera-0.8 >/dev/null") != 0)
      GTEST_SKIP() << "arv-fake-gv-camera-0.8 is missing: install aravis-tools";
    if (!has_element("aravissrc")) GTEST_SKIP() << "aravissrc is missing: install libaravis-0.8-0";
  }

  /// As root, Aravis uses packet sockets, which receive nothing on loopback.
  static std::vector<std::string> without_raw_sockets(std::vector<std::string> words) {
    if (geteuid() == 0)
      words.insert(words.begin(),
                   {"setpriv", "--bounding-set", "-net_raw", "--inh-caps", "-net_raw"});
    return words;
  }

  void expect_line(const std::string& kind, const std::string& features, bool gray) {
    const std::string name = "test" + std::to_string(getpid());
    Process fake(without_raw_sockets({"arv-fake-gv-camera-0.8", "-i", "127.0.0.1", "-s", name}));
    // The first frames can get lost, and with them the stream: try again.
    for (int attempt = 0; attempt < 4; ++attempt) {
      std::this_thread::sleep_for(std::chrono::seconds(1));
      ASSERT_TRUE(fake.running()) << fake.output();
      Process line(without_raw_sockets({script("aravis"), "", kind}),
                   environment({{"SOURCE", "aravissrc camera-name=Aravis-Fake-" + name +
                                               " num-buffers=20 " + features},
                                {"SINK", raw_file(file("out.mkv"))}}));
      const int status = line.wait(40);
      output_ = line.output();
      if (status != 0) continue;
      const Media media = read_media(file("out.mkv"));
      if (media.frames.empty()) continue;
      ASSERT_TRUE(media.errors.empty()) << media.errors.front();
      EXPECT_EQ(media.frames.back().width, 512);
      EXPECT_EQ(media.frames.back().height, 512);
      // The fake camera sends a diagonal ramp that moves.
      EXPECT_GT(media.frames.back().variance(0, 0, .5, .5), 100);
      if (gray) {
        EXPECT_NEAR(media.frames.back().mean(0), media.frames.back().mean(2), 2);
      }
      for (size_t i = 1; i < media.times.size(); ++i) EXPECT_GT(media.times[i], media.times[i - 1]);
      return;
    }
    FAIL() << "no frame came in four attempts:\n" << output_ << fake.output();
  }
};

TEST_F(Aravis, Bayer) { expect_line("bayer", "", false); }
TEST_F(Aravis, Mono) { expect_line("mono", "", true); }

/// Lights and camera in step, to the program's end.
TEST_F(PipelineTest, LightStageAravis) {
  if (system("command -v arv-fake-gv-camera-0.8 >/dev/null") != 0)
    GTEST_SKIP() << "arv-fake-gv-camera-0.8 is missing: install aravis-tools";
  if (!has_element("lightstagearavissrc"))
    GTEST_SKIP() << "the plugin was built without Aravis: install libaravis-dev";
  const std::string name = "stage" + std::to_string(getpid());
  Process fake({"arv-fake-gv-camera-0.8", "-i", "127.0.0.1", "-s", name});
  // A camera of which one is there already is found only when that has gone.
  for (int attempt = 0; attempt < 4; ++attempt) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    ASSERT_TRUE(fake.running()) << fake.output();
    if (run("light-stage-aravis", {"Aravis-Fake-" + name, "static:12"},
            {{"SINK", raw_file(file("out.mkv"))}}) == 0)
      break;
  }
  const Media media = read_media(file("out.mkv"));
  ASSERT_TRUE(media.errors.empty()) << media.errors.front() << output_;
  // The marker, twelve lights, full on after eleven and at the end, two gradients.
  ASSERT_EQ(media.frames.size(), 3U + 12 + 2 + 2) << output_;
  EXPECT_EQ(media.frames.back().width, 512);
  EXPECT_GT(media.frames.back().variance(0, 0, .5, .5), 100);
}

}  // namespace
}  // namespace inverse::testing
