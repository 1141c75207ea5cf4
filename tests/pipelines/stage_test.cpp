// SPDX-License-Identifier: LGPL-2.1-or-later
// Lines of the virtual light stage.
#include <fstream>

#include "pipeline_test.hpp"

namespace inverse::testing {
namespace {

class Stage : public PipelineTest {};

double brightness(const Image& image) {
  return (image.mean(0) + image.mean(1) + image.mean(2)) / 3;
}

TEST_F(Stage, StaticCaptureToAFile) {
  ASSERT_EQ(run("virtual-stage", {"static:12", file("out.mkv"), "160", "120"}), 0) << output_;
  const Media movie = read_media(file("out.mkv"));
  EXPECT_TRUE(movie.errors.empty());
  // The marker, twelve lights with a full-on frame after the 11th and the last, two gradients.
  ASSERT_EQ(movie.frames.size(), 3U + 12 + 2 + 2);
  EXPECT_EQ(movie.frames[0].width, 160);
  EXPECT_EQ(movie.frames[0].height, 120);
  for (const size_t black : {0U, 2U}) EXPECT_LT(brightness(movie.frames[black]), 0.5) << black;
  for (const size_t full : {1U, 14U, 16U})
    EXPECT_NEAR(brightness(movie.frames[full]), 64.6, 1) << full;
  for (size_t olat = 3; olat < 14; ++olat)
    EXPECT_LT(brightness(movie.frames[olat]), brightness(movie.frames[1]) / 2) << olat;
  // Gradient A is red from the right, B from the left.
  const Image &a = movie.frames[17], &b = movie.frames[18];
  EXPECT_GT(a.mean(0, .5), a.mean(0, 0, 0, .5) + 2);
  EXPECT_LT(b.mean(0, .5), b.mean(0, 0, 0, .5) - 2);
}

TEST_F(Stage, APerformanceIsRelit) {
  // A frame pair in two: 60 frames a second make 30.
  ASSERT_EQ(
      run("relight", {"", file("out.mkv"), "96", "64"}, {{"FRAMES", "23"}, {"LIGHT_COUNT", "42"}}),
      0)
      << output_;
  const Media movie = read_media(file("out.mkv"));
  EXPECT_TRUE(movie.errors.empty());
  ASSERT_EQ(movie.frames.size(), 10U);  // behind the marker
  EXPECT_EQ(movie.frames[0].width, 96);
  const double relit[] = {32.1, 27.9, 27.1};  // in the studio's light
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(movie.frames[5].mean(c), relit[c], 1) << c;
}

TEST_F(Stage, NoResultIsReplacedUnasked) {
  for (const auto& [name, first] : {std::pair{"virtual-stage", "performance:8"}, {"relight", ""}}) {
    std::ofstream(file("mine.mkv")) << "mine";
    std::vector<std::string> words{first, file("mine.mkv"), "48", "48"};
    const Process::Environment few{{"FRAMES", "13"}, {"LIGHT_COUNT", "8"}};
    expect_failure(name, words, "mine.mkv is there already", few);
    EXPECT_EQ(std::filesystem::file_size(file("mine.mkv")), 4u);
    words.push_back("--overwrite");
    EXPECT_EQ(run(name, words, few), 0) << output_;
    EXPECT_GT(std::filesystem::file_size(file("mine.mkv")), 500u);
  }
  const std::string program = file("mine.mkv");
  expect_failure("virtual-stage", {program, program, "--overwrite"}, "would replace the input");
}

TEST_F(Stage, MissingInputIsAnError) {
  expect_failure("relight", {"/no/such/map.hdr"}, "there is no environment map");
  expect_failure("virtual-stage", {"/no/such/program.json", file("out.mkv")},
                 "there is no light program");
  expect_failure("virtual-stage", {"static:4", "/no/such/folder/out.mkv"}, "there is no folder");
}

}  // namespace
}  // namespace inverse::testing
