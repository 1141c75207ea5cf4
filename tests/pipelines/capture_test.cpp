// SPDX-License-Identifier: LGPL-2.1-or-later
// The line that writes a static capture of a light stage.
#include <filesystem>
#include <fstream>

#include "pipeline_test.hpp"

namespace inverse::testing {
namespace {

class Capture : public PipelineTest {};

TEST_F(Capture, EveryLightIsWritten) {
  ASSERT_EQ(run("static-capture", {"static:20", file("set"), "160", "120"}), 0) << output_;
  const std::filesystem::path folder = file("set") + "/camera_0";
  size_t lights = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "olat"))
    lights += entry.path().extension() == ".exr" && entry.file_size() > 10000 ? 1 : 0;
  EXPECT_EQ(lights, 20U);
  for (const char* name : {"tracking.exr", "gradient-a.exr", "gradient-b.exr", "lights.json"})
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
}

/// The earlier capture stays.
TEST_F(Capture, AnIncompleteOneIsAnError) {
  const std::string part =
      "lightstagetestsrc is-live=false program=static:20 num-buffers=15 ! "
      "video/x-raw,format=RGBA64_LE,width=160,height=120";
  const std::vector<std::string> words{"static:20", file("set"), "--overwrite"};
  expect_failure("static-capture", words, "11 of 20 lights", {{"SOURCE", part}});
  ASSERT_EQ(run("static-capture", {"static:20", file("set"), "160", "120", "--overwrite"}), 0)
      << output_;
  expect_failure("static-capture", {"static:20", file("set")}, "there already");
  expect_failure("static-capture", words, "there is no new capture", {{"SOURCE", part}});
  expect_failure("static-capture", words, "there is no new capture",
                 {{"SOURCE", "videotestsrc num-buffers=20"}});
  EXPECT_TRUE(std::filesystem::exists(file("set") + "/camera_0/olat/019.exr"));
}

TEST_F(Capture, IsRelit) {
  ASSERT_EQ(run("static-capture", {"static:42", file("set"), "96", "64"}), 0) << output_;
  ASSERT_EQ(run("relight-capture", {file("set") + "/camera_0", file("relit.png")}), 0) << output_;
  const Media picture = read_media(file("relit.png"));
  ASSERT_EQ(picture.frames.size(), 1U);
  EXPECT_EQ(picture.frames[0].width, 96);
  const double relit[] = {39.2, 34.3, 32.7};  // in the studio's light
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(picture.frames[0].mean(c), relit[c], 1) << c;
}

TEST_F(Capture, MissingInputIsAnError) {
  expect_failure("relight-capture", {file("none"), file("relit.png")}, "it has no lights.json");
  expect_failure("static-capture", {"/no/such/program.json", file("set")},
                 "there is no light program");
  expect_failure("static-capture", {"static:4", "/proc/nowhere"}, "/proc/nowhere");
}

}  // namespace
}  // namespace inverse::testing
