// SPDX-License-Identifier: LGPL-2.1-or-later
// rgbdsrc: recordings with faults.
#include <filesystem>

#include "played.hpp"

namespace inverse::testing {
namespace {

// What cannot be read is skipped, and said once.
TEST(RgbdSrc, SkipsBadFrames) {
  const TemporaryFolder folder;
  write_folders(folder, 10);
  std::filesystem::remove(folder / "color/10.png");  // the third: not listed
  write_depth(folder, "depth/11.png", 9, 32, 24);    // of another size
  write_color(folder, "color/12.png", 9, 32, 24);    // the same
  write_color(folder, "depth/13.png", 9);            // of 8 bits, and color
  folder.write("color/14.png", "no picture");        //
  write_file(folder, "depth/8.png", png(64, 48, 1, 8, std::vector<uint8_t>(64 * 48)));
  std::filesystem::resize_file(folder / "depth/15.png", 2000);  // it ends too early
  const Played played = play(folder.path() + " framerate=10", "", [&](size_t n) {
    if (n == 0) std::filesystem::remove(folder / "color/17.png");  // while it plays
  });
  expect_red(played, {20, 90});
  ASSERT_EQ(played.buffers.size(), 2U);
  EXPECT_EQ(played.buffers[1].time, 800 * GST_MSECOND);
  EXPECT_TRUE(played.line.eos);
  EXPECT_EQ(played.unpaired, 1U);
  EXPECT_EQ(played.skipped, 6U) << "when the last frame came";
  ASSERT_EQ(played.line.warnings.size(), 2U);
  EXPECT_NE(played.line.warnings[0].find("depth/10.png has no picture"), std::string::npos)
      << played.line.warnings[0];
  EXPECT_NE(played.line.warnings[1].find("depth/8.png: it has 8 bits"), std::string::npos)
      << played.line.warnings[1];
}

// A loop over files that are gone ends.
TEST(RgbdSrc, EndsWhenTheRecordingIsRemoved) {
  const TemporaryFolder folder;
  write_folders(folder, 6);
  const Played played = play(folder.path() + " loop=true", "", [&](size_t n) {
    if (n == 0) std::filesystem::remove_all(folder / "color");
  });
  EXPECT_NE(played.line.first_error().find("none of the recording's frames can be read any more"),
            std::string::npos)
      << played.line.first_error();
}

TEST(RgbdSrc, BadListsAreSaid) {
  const TemporaryFolder folder;
  write_tum(folder);
  folder.write("rgb.txt",
               "x.1 rgb/a.png\n100.000 rgb/a.png\n100.000 rgb/d.png\nnan rgb/b.png\n100.030\n"
               "100.03 rgb/b.png\n1e400 rgb/b.png\n");
  folder.write("groundtruth.txt",
               "100 1 2 3 0 0 0 1\n100.01 nan 2 3 0 0 0 1\n100.02 1 2 3 0 0 0 0\n1 2 3\n"
               "100.03 1 2 1e9 0 0 0 1\n");
  const Played played = play(folder.path());
  expect_red(played, {10, 20});
  ASSERT_EQ(played.line.warnings.size(), 4U);
  const char* said[] = {"rgb.txt: line 1 and 3 more are not \"time file\"",
                        "rgb.txt: lines with the time of another: 1",
                        "depth.txt: its times go back",
                        "groundtruth.txt: line 2 and 3 more are not \"time tx ty tz qx qy qz qw\""};
  for (size_t i = 0; i < 4; ++i)
    EXPECT_NE(played.line.warnings[i].find(said[i]), std::string::npos) << played.line.warnings[i];
  EXPECT_TRUE(played.buffers[0].meta.posed);
  folder.write("groundtruth.txt", "nothing\n");
  const Played without = play(folder.path());
  EXPECT_EQ(without.buffers.size(), 2U) << without.line.first_error();
  EXPECT_NE(without.line.warnings.back().find("has no poses"), std::string::npos);
  folder.write("groundtruth.txt", "1 1 2 3 0 0 0 1\n");
  const Played apart = play(folder.path());
  EXPECT_EQ(apart.buffers.size(), 2U);
  EXPECT_NE(apart.line.warnings.back().find("from 1.000 to 1.000 s"), std::string::npos);
}

TEST(RgbdSrc, WhatIsNoRecordingIsAnError) {
  const TemporaryFolder folder;
  const auto expect_error = [&](const std::string& settings, const std::string& said) {
    const Played played = play(settings);
    EXPECT_NE(played.line.first_error().find(said), std::string::npos)
        << settings << ": " << played.line.first_error();
    EXPECT_TRUE(played.buffers.empty());
  };
  const auto path = [&](const char* name) { return folder / name; };
  expect_error("\"\"", "location is not set");
  expect_error("/nowhere/at/all", "/nowhere/at/all: it cannot be read");
  expect_error("file:///tmp", "not a URI");
  expect_error(folder.path(), "is no recording");
  expect_error(folder.write("clip.mkv", "\x1a\x45\xdf\xa3"), "rgbdmerge");
  std::filesystem::create_directories(path("empty/color"));
  std::filesystem::create_directories(path("empty/depth"));
  expect_error(path("empty"), "empty/color has no PNG or JPEG pictures");
  expect_error(path("empty") + " color-folder=none", "empty/none: it cannot be read");
  write_color(folder, "odd/color/a.png", 1);
  write_color(folder, "odd/color/b.png", 1);
  write_depth(folder, "odd/depth/c.png", 1);
  expect_error(path("odd"), "do not tell which belong together");
  write_color(folder, "odd/color/0.png", 1);
  write_depth(folder, "odd/depth/0.png", std::vector<uint16_t>(64 * 48, 1000), 64, 48);
  folder.write("odd/meta.json", R"({"depth_units_per_metre":0,"frames":[]})");
  expect_error(path("odd"), "\"depth_units_per_metre\" must be above 1");
  folder.write("odd/meta.json", R"({"frames":[{"camera":{"width":64}}]})");
  expect_error(path("odd"), "does not describe a recording");
  folder.write("odd/meta.json", R"({"frames":[{"frame":"a","camera":{}}]})");
  expect_error(path("odd"), "does not describe a recording");
  folder.write("odd/meta.json",
               R"({"frames":[{"camera":{"width":64,"height":48,"fx":0,"fy":50,"cx":0,"cy":0}}]})");
  expect_error(path("odd"), "a focal length that is not above 0");
  folder.write("odd/meta.json", "{");
  expect_error(path("odd"), "is not valid JSON");
  std::filesystem::remove(path("odd/meta.json"));
  expect_error(path("odd") + " calibration=/nowhere.json",
               "calibration /nowhere.json cannot be read");
  expect_error(path("odd") + " poses=/nowhere.txt", "/nowhere.txt: it cannot be read");
  write_color(folder, "color/1.png", 1);
  write_color(folder, "depth/1.png", 1);
  expect_error(folder.path(), "depth images are gray PNG files of 16 bits");
  folder.write("rgb.txt", "# nothing\n");
  expect_error(folder.path(), "rgb.txt lists no file");
  folder.write("rgb.txt", "1 color/1.png\n");
  expect_error(folder.path(), "depth.txt: it cannot be read");
  folder.write("depth.txt", "2 depth/1.png\n");
  expect_error(folder.path(), "none of the pictures of rgb.txt has a depth image");
  folder.write("rgb.txt", "1 color/1.png\n9e11 color/1.png\n");
  folder.write("depth.txt", "1 depth/1.png\n9e11 depth/1.png\n");
  expect_error(folder.path(), "first and last time stamp");
}

}  // namespace
}  // namespace inverse::testing
