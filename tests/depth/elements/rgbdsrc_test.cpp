// SPDX-License-Identifier: LGPL-2.1-or-later
// rgbdsrc, by whole lines.
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "played.hpp"
#include "tests/pipeline.hpp"

namespace inverse::testing {
namespace {

TEST(RgbdSrc, PlaysTum) {
  const TemporaryFolder folder;
  write_tum(folder);
  const Played played = play(folder.path());
  expect_red(played, {10, 20, 40});
  ASSERT_EQ(played.buffers.size(), 3U);
  ASSERT_EQ(played.line.warnings.size(), 1U) << "that depth.txt goes back in time";
  EXPECT_NE(played.line.warnings[0].find("depth.txt: its times go back"), std::string::npos);
  EXPECT_EQ(played.unpaired, 2U);
  const GstClockTime times[] = {0, 30 * GST_MSECOND, 105 * GST_MSECOND};
  for (size_t n = 0; n < 3; ++n) {
    EXPECT_NEAR(double(played.buffers[n].time), double(times[n]), 1000) << n;
    EXPECT_EQ(played.buffers[n].offset, n);
    EXPECT_EQ(played.buffers[n].meta.unit, 1 / 5000.0);
    EXPECT_DOUBLE_EQ(played.buffers[n].meta.fx, 52.5) << "525 at 640 pixels";
    EXPECT_DOUBLE_EQ(played.buffers[n].meta.cx, 31.5);
  }
  EXPECT_EQ(played.buffers[0].duration, played.buffers[1].time);
  expect_depth(played.buffers[0], 1000);
  expect_depth(played.buffers[1], 2000);
  expect_depth(played.buffers[2], 4000);
  // The first picture comes before all poses, the second between two, the last after all.
  const auto expect_pose = [](const RgbdBuffer& buffer, double n) {
    ASSERT_TRUE(buffer.meta.posed);
    const double turn = n * M_PI / 180, c = std::cos(turn), s = std::sin(turn);
    const double rows[] = {c, 0, s, n, 0, 1, 0, 2, -s, 0, c, 3};
    for (size_t i = 0; i < 12; ++i) EXPECT_NEAR(buffer.meta.pose[i], rows[i], 1e-6) << i;
  };
  expect_pose(played.buffers[0], 0);
  expect_pose(played.buffers[1], 2.5);
  EXPECT_FALSE(played.buffers[2].meta.posed) << "30 ms after the last pose";
  EXPECT_EQ(played.posed, 2U);
}

// As Python prints times, numbers have as many digits as they need.
TEST(RgbdSrc, NamesThatAreTimesComeInTheirOrder) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"1560000083.9", "1560000083.933", "1560000083.95",
                                 "1560000083.966667", "1560000084.0", "1560000084.033"},
        {"frame-0.05", "frame-0.1", "frame-0.15", "frame-1.0", "frame-9.5", "frame-10.05"},
        {"1.9", "1.10", "1.11", "2.1", "2.2", "2.10"},  // shots and frames
        {"0.90", "0.95", "1.00", "1.05", "10.00", "10.05"},
        {"8", "9", "10", "11", "100", "101"}}) {
    const TemporaryFolder folder;
    std::vector<uint8_t> red;
    for (const std::string& name : names) {
      red.push_back(static_cast<uint8_t>(10 * (red.size() + 1)));
      write_color(folder, "color/" + name + ".png", red.back());
      write_depth(folder, "depth/" + name + ".png", static_cast<uint16_t>(1000));
    }
    expect_red(play(folder.path()), red);
  }
}

// Two lists of stamps much denser than max-difference.
TEST(RgbdSrc, DenseListsArePairedOneToOne) {
  const TemporaryFolder folder;
  write_color(folder, "c.png", 10);
  write_depth(folder, "d.png", uint16_t{1000});
  std::ostringstream color, depth;
  constexpr int kLines = 20000;
  for (int n = 0; n < kLines; ++n) {
    color << std::fixed << std::setprecision(7) << 100 + n * 1e-7 << " c.png\n";
    depth << std::fixed << std::setprecision(7) << 100 + n * 1e-7 << " d.png\n";
  }
  folder.write("rgb.txt", color.str());
  folder.write("depth.txt", depth.str());
  const LineResult line = run_line("rgbdsrc num-buffers=3 location=" + folder.path() +
                                   " ! appsink name=out sync=false");
  EXPECT_EQ(line.frames.size(), 3U) << line.first_error();
}

TEST(RgbdSrc, SettingsWinOverTheRecording) {
  const TemporaryFolder folder;
  write_tum(folder);
  folder.write("truth.txt", "100.1 7 8 9 0 0 0 1\n");
  const Played played =
      play(folder.path() + " depth-unit=0.002 fx=60 cy=20 framerate=10 max-difference=45 poses=" +
           (folder / "truth.txt"));
  ASSERT_EQ(played.buffers.size(), 4U) << played.line.first_error();
  for (size_t n = 0; n < 4; ++n) {
    const RgbdBuffer& buffer = played.buffers[n];
    EXPECT_EQ(buffer.time, n * 100 * GST_MSECOND);
    EXPECT_EQ(buffer.meta.unit, 0.002);
    EXPECT_EQ(buffer.meta.fx, 60);
    EXPECT_EQ(buffer.meta.fy, 60);
    EXPECT_DOUBLE_EQ(buffer.meta.cx, 31.5);
    EXPECT_EQ(buffer.meta.cy, 20);
    EXPECT_EQ(buffer.meta.posed, n > 1) << "by the recording's time";
  }
  EXPECT_EQ(played.buffers[3].meta.pose[3], 7);
  EXPECT_EQ(played.line.info.fps_n, 10);
  const Played without = play(folder.path() + " attach-poses=false");
  for (const RgbdBuffer& buffer : without.buffers) EXPECT_FALSE(buffer.meta.posed);
}

TEST(RgbdSrc, Plays7Scenes) {
  const TemporaryFolder folder;
  for (int n = 0; n < 4; ++n) {
    const std::string start = "frame-00000" + std::to_string(n);
    write_color(folder, start + ".color.png", static_cast<uint8_t>(10 * (n + 1)));
    if (n != 1) write_depth(folder, start + ".depth.png", static_cast<uint16_t>(1000 * (n + 1)));
  }
  folder.write("frame-000000.pose.txt", " 1 0 0 0.5\n0 0 -1 1.5\n0 1\t0 2.5\n0 0 0 1\n");
  folder.write("frame-000002.pose.txt", "nan 0 0 1\n0 1 0 1\n0 0 1 1\n0 0 0 1\n");
  const Played played = play(folder.path());
  expect_red(played, {10, 30, 40});
  ASSERT_EQ(played.buffers.size(), 3U);
  EXPECT_EQ(played.buffers[1].time, 66666667U) << "the time of what is missing stays";
  expect_depth(played.buffers[1], 3000);
  const GstInverseDepthMeta& meta = played.buffers[0].meta;
  EXPECT_EQ(meta.unit, 0.001);
  EXPECT_DOUBLE_EQ(meta.fx, 58.5) << "585 at 640 pixels";
  EXPECT_DOUBLE_EQ(meta.cx, 31.55) << "320 at 640 pixels, with pixel centers at whole numbers";
  ASSERT_TRUE(meta.posed);
  const double rows[] = {1, 0, 0, .5, 0, 0, -1, 1.5, 0, 1, 0, 2.5};
  for (size_t i = 0; i < 12; ++i) EXPECT_EQ(meta.pose[i], rows[i]);
  EXPECT_FALSE(played.buffers[1].meta.posed);
  EXPECT_FALSE(played.buffers[2].meta.posed) << "it has no file";
  ASSERT_EQ(played.line.warnings.size(), 2U);
  EXPECT_NE(played.line.warnings[0].find("1 pose cannot be used"), std::string::npos);
  EXPECT_NE(played.line.warnings[1].find("frame-000001.color.png has no depth image"),
            std::string::npos);
}

TEST(RgbdSrc, PlaysFolders) {
  const TemporaryFolder folder;
  write_folders(folder, 3);
  const Played played = play(folder.path() + " framerate=12.5");
  expect_red(played, {10, 20, 30});
  EXPECT_TRUE(played.line.warnings.empty());
  for (size_t n = 0; n < played.buffers.size(); ++n) {
    const RgbdBuffer& buffer = played.buffers[n];
    expect_depth(buffer, static_cast<uint16_t>(1000 * (n + 1)));
    EXPECT_EQ(buffer.time, n * 80 * GST_MSECOND);
    EXPECT_EQ(buffer.duration, 80 * GST_MSECOND);
    EXPECT_EQ(buffer.meta.unit, 0.001);
    EXPECT_NEAR(buffer.meta.fx, 32 / std::tan(31 * M_PI / 180), 1e-9);
    EXPECT_FALSE(buffer.meta.posed);
  }
  EXPECT_EQ(played.line.info.fps_n, 25);
  EXPECT_EQ(played.line.info.fps_d, 2);
}

// Names differ, depth is smaller, and there are two kinds of it.
TEST(RgbdSrc, PairsByNumberOrOrder) {
  const TemporaryFolder folder;
  write_folders(folder, 3, "pictures/rgb_000", "depth/d");
  for (const char* name : {"left", "middle", "right"})
    write_depth(folder, std::string("coarse/") + name + ".png", 500, 32, 24);
  const Played numbers = play(folder.path() + " color-folder=pictures");
  expect_red(numbers, {10, 20, 30});
  for (size_t n = 0; n < numbers.buffers.size(); ++n)
    expect_depth(numbers.buffers[n], static_cast<uint16_t>(1000 * (n + 1)));
  const Played order = play(folder.path() + " color-folder=pictures depth-folder=coarse fx=50");
  ASSERT_EQ(order.buffers.size(), 3U) << order.line.first_error();
  expect_depth(order.buffers[2], 500);
  EXPECT_EQ(order.buffers[2].meta.width, 32U);
  EXPECT_EQ(order.buffers[2].meta.fx, 25) << "in pixels of the depth image";
  EXPECT_DOUBLE_EQ(order.buffers[2].meta.cx, 15.5);
}

TEST(RgbdSrc, PlaysJpeg) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "color");
  ASSERT_TRUE(run_line("videotestsrc num-buffers=2 pattern=green ! video/x-raw,width=64,height=48 "
                       "! jpegenc ! multifilesink location=" +
                       folder.path() + "/color/%04d.jpg")
                  .eos);
  write_depth(folder, "depth/0000.png", 1000);
  write_depth(folder, "depth/0001.png", 2000);
  const Played played = play(folder.path());
  ASSERT_EQ(played.line.frames.size(), 2U) << played.line.first_error();
  EXPECT_LT(played.line.frames[1][0], 40);
  EXPECT_GT(played.line.frames[1][1], 200);
  expect_depth(played.buffers[1], 2000);
}

// The layout of the bundled renderings: lens, poses and unit are in meta.json.
TEST(RgbdSrc, ReadsMetaJson) {
  const TemporaryFolder folder;
  for (int n = 0; n < 2; ++n) {
    write_color(folder, "I8/00" + std::to_string(n) + ".png", 10);
    for (const char* kind : {"Z", "Zkinect"})
      write_depth(folder, std::string(kind) + "/00" + std::to_string(n) + ".png",
                  kind[1] ? 1000 : 3000);
  }
  const auto camera = [](int frame, const std::string& pose) {
    return R"({"frame":)" + std::to_string(frame) +
           R"(,"camera":{"width":128,"height":96,"fx":100,"fy":110,"cx":63.5,"cy":47.5,)"
           R"("cam_to_world_opencv":)" +
           pose + "}}";
  };
  folder.write("meta.json", R"({"depth_units_per_metre":4000,"frames":[)" +
                                camera(0, "[[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]") + "," +
                                camera(1, "[[1,0,0,1],[0,0,0,2],[0,0,1,3],[0,0,0,1]]") + "]}");
  const Played played = play(folder.path());
  ASSERT_EQ(played.buffers.size(), 2U) << played.line.first_error();
  const GstInverseDepthMeta& meta = played.buffers[0].meta;
  EXPECT_EQ(meta.unit, 1 / 4000.0);
  EXPECT_EQ(meta.fx, 50) << "half the size";
  EXPECT_EQ(meta.fy, 55);
  EXPECT_EQ(meta.cx, 31.5);
  ASSERT_TRUE(meta.posed);
  EXPECT_EQ(meta.pose[7], 2);
  expect_depth(played.buffers[0], 1000);
  EXPECT_FALSE(played.buffers[1].meta.posed) << "a matrix that is no rotation";
  ASSERT_EQ(played.line.warnings.size(), 1U);
  folder.write("meta.json", R"({"frames":[)" + camera(7, "[]") + "]}");
  const Played other = play(folder.path());
  ASSERT_EQ(other.line.warnings.size(), 1U) << other.line.first_error();
  EXPECT_NE(other.line.warnings[0].find("none of its frames has the number"), std::string::npos);
  EXPECT_FALSE(other.buffers.at(0).meta.posed);
  EXPECT_EQ(other.buffers.at(0).meta.unit, 0.001);
  const Played exact = play(folder.path() + " depth-folder=Z");
  ASSERT_EQ(exact.buffers.size(), 2U);
  expect_depth(exact.buffers[0], 3000);
}

TEST(RgbdSrc, CalibrationMovesDepthToThePicture) {
  const TemporaryFolder folder;
  const std::string camera = R"({"size":[64,48],"matrix":[[60,0,31.5],[0,60,23.5],[0,0,1]]})";
  folder.write("rgb.txt", "1 c.png\n");
  folder.write("depth.txt", "1 d.png\n");
  write_color(folder, "c.png", 10);
  write_depth(folder, "d.png", std::vector<uint16_t>(64 * 48, 5000), 64, 48);
  const std::string file = folder.write("c.json", R"({"color":)" + camera + R"(,"depth":)" +
                                                      camera + R"(,"translation":[-0.1,0,0]})");
  const Played played = play(folder.path() + " calibration=" + file);
  ASSERT_EQ(played.buffers.size(), 1U) << played.line.first_error();
  EXPECT_EQ(played.buffers[0].meta.unit, 1 / 5000.0) << "that file says nothing of it";
  EXPECT_EQ(played.buffers[0].meta.fx, 60);
  EXPECT_EQ(played.buffers[0].steps[24 * 64 + 50], 5000);
  EXPECT_EQ(played.buffers[0].steps[24 * 64 + 60], 0) << "6 pixels to the left at 1 m";
}

TEST(RgbdSrc, SeeksAndKnowsItsLength) {
  const TemporaryFolder folder;
  write_folders(folder, 10);
  Pipeline pipeline("rgbdsrc name=source framerate=10 location=" + folder.path() +
                    " ! appsink name=out sync=false max-buffers=1");
  ASSERT_TRUE(pipeline.reaches(GST_STATE_PAUSED));
  gint64 duration = 0, position = 0;
  ASSERT_TRUE(gst_element_query_duration(pipeline.get(), GST_FORMAT_TIME, &duration));
  EXPECT_EQ(duration, gint64(GST_SECOND));
  const auto next = [&] {
    RgbdBuffer buffer;
    if (GstSample* sample = pipeline.sample("out")) {
      buffer = rgbd_buffer(gst_sample_get_buffer(sample));
      gst_sample_unref(sample);
    }
    return buffer;
  };
  constexpr auto kFlags = static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE);
  pipeline.set(GST_STATE_PLAYING);
  for (const auto& [to, frame] : {std::pair{700, 7U}, {150, 1U}, {0, 0U}, {999, 9U}, {200, 2U}}) {
    ASSERT_TRUE(
        gst_element_seek_simple(pipeline.get(), GST_FORMAT_TIME, kFlags, to * gint64(GST_MSECOND)));
    const RgbdBuffer buffer = next();
    EXPECT_EQ(buffer.time, frame * 100 * GST_MSECOND) << to;
    EXPECT_EQ(buffer.offset, frame);
    expect_depth(buffer, static_cast<uint16_t>(1000 * (frame + 1)));
  }
  EXPECT_EQ(next().offset, 3U);
  ASSERT_TRUE(gst_element_query_position(pipeline.get(), GST_FORMAT_TIME, &position));
  EXPECT_GE(position, gint64(200 * GST_MSECOND));
  // Up to a stop, and from the end.
  ASSERT_TRUE(gst_element_seek(pipeline.get(), 1, GST_FORMAT_TIME, kFlags, GST_SEEK_TYPE_SET,
                               300 * gint64(GST_MSECOND), GST_SEEK_TYPE_SET,
                               500 * gint64(GST_MSECOND)));
  EXPECT_EQ(next().offset, 3U);
  EXPECT_EQ(next().offset, 4U);
  EXPECT_TRUE(pipeline.ends());
  ASSERT_TRUE(gst_element_seek_simple(pipeline.get(), GST_FORMAT_TIME, kFlags, 5 * GST_SECOND));
  EXPECT_TRUE(pipeline.ends()) << "beyond the end";
  EXPECT_FALSE(gst_element_seek(pipeline.get(), -1, GST_FORMAT_TIME, kFlags, GST_SEEK_TYPE_SET, 0,
                                GST_SEEK_TYPE_SET, GST_SECOND));
}

TEST(RgbdSrc, Loops) {
  const TemporaryFolder folder;
  write_folders(folder, 3);
  const Played played = play(folder.path() + " loop=true framerate=10 num-buffers=8");
  expect_red(played, {10, 20, 30, 10, 20, 30, 10, 20});
  for (size_t n = 0; n < played.buffers.size(); ++n)
    EXPECT_EQ(played.buffers[n].time, n * 100 * GST_MSECOND) << "times go on";
  Pipeline pipeline("rgbdsrc name=source loop=true framerate=10 location=" + folder.path() +
                    " ! appsink name=out sync=false max-buffers=1");
  ASSERT_TRUE(pipeline.reaches(GST_STATE_PAUSED));
  gint64 duration = 0;
  EXPECT_FALSE(gst_element_query_duration(pipeline.get(), GST_FORMAT_TIME, &duration));
  ASSERT_TRUE(gst_element_seek_simple(pipeline.get(), GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                                      1000 * gint64(GST_MSECOND)));
  pipeline.set(GST_STATE_PLAYING);
  GstSample* sample = pipeline.sample("out");
  ASSERT_NE(sample, nullptr);
  const RgbdBuffer buffer = rgbd_buffer(gst_sample_get_buffer(sample));
  gst_sample_unref(sample);
  EXPECT_EQ(buffer.time, GST_SECOND);
  expect_depth(buffer, 2000);
  // The round that has begun is the last.
  g_object_set(pipeline.find("source"), "loop", FALSE, nullptr);
  while (GstSample* last = pipeline.sample("out")) gst_sample_unref(last);
  EXPECT_TRUE(gst_app_sink_is_eos(GST_APP_SINK(pipeline.find("out"))));
}

TEST(RgbdSrc, PlaysLive) {
  const TemporaryFolder folder;
  write_folders(folder, 5);
  Pipeline pipeline("rgbdsrc is-live=true framerate=10 location=" + folder.path() +
                    " ! fakesink sync=false");
  EXPECT_EQ(pipeline.set(GST_STATE_PAUSED), GST_STATE_CHANGE_NO_PREROLL);
  const GstClockTime start = gst_util_get_timestamp();
  pipeline.set(GST_STATE_PLAYING);
  EXPECT_FALSE(
      gst_element_seek_simple(pipeline.get(), GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH, GST_SECOND));
  EXPECT_TRUE(pipeline.ends());
  EXPECT_GE(gst_util_get_timestamp() - start, 350 * GST_MSECOND);
}

// A recording of rgbdtestsrc is decomposed as what it was made of.
TEST(RgbdSrc, DecomposesAsTheCamera) {
  const TemporaryFolder folder;
  const std::string camera =
      "rgbdtestsrc is-live=false samples=1 num-buffers=6 path=wall speed=10 ! "
      "video/x-raw,format=RGB,width=96,height=72 ! ";
  size_t n = 0;
  double fx = 0;
  const LineResult recorded =
      run_line(camera + "appsink name=out sync=false", 120, [&](GstElement* pipeline) {
        watch_buffers(find_element(pipeline, "out"), "sink", [&](GstBuffer* buffer) {
          const RgbdBuffer seen = rgbd_buffer(buffer);
          const std::string start = "frame-00000" + std::to_string(n++);
          write_file(folder, start + ".color.png", png(96, 72, 3, 8, bytes_of(buffer)));
          write_depth(folder, start + ".depth.png", seen.steps, 96, 72);
          std::ostringstream pose;
          pose << std::setprecision(17);
          for (const double value : seen.meta.pose) pose << value << " ";
          folder.write(start + ".pose.txt", pose.str() + "0 0 0 1\n");
          fx = seen.meta.fx;
        });
      });
  ASSERT_EQ(n, 6U) << recorded.first_error();
  std::ostringstream settings;
  settings << std::setprecision(17) << "rgbdsrc location=" << folder.path() << " fx=" << fx
           << " cx=47.5 cy=35.5 ! ";
  guint blocks = 0;
  gboolean found = FALSE;
  const auto decompose = [&](const std::string& source) {
    return run_line(
        source +
            "intrinsicdecomp name=decomposer show=reflectance scene::track=false ! "
            "video/x-raw,format=RGBA ! appsink name=out sync=false",
        240, [&](GstElement* pipeline) {
          watch_buffers(find_element(pipeline, "out"), "sink", [&, pipeline](GstBuffer*) {
            GstElement* decomposer = find_element(pipeline, "decomposer");
            blocks = find_stat<guint>(decomposer, "scene-blocks").value_or(0);
            found = find_stat<bool>(decomposer, "scene-camera-found").value_or(false);
          });
        });
  };
  const LineResult played = decompose(settings.str());
  ASSERT_EQ(played.frames.size(), 6U) << played.first_error();
  EXPECT_TRUE(played.warnings.empty()) << played.warnings.front();
  EXPECT_GT(blocks, 500U);
  EXPECT_TRUE(found);
  const LineResult direct = decompose(camera);
  ASSERT_EQ(direct.frames.size(), 6U) << direct.first_error();
  for (size_t i = 0; i < 6; ++i)
    EXPECT_LE(largest_difference(played.frames[i], direct.frames[i]), 1) << i;
}

}  // namespace
}  // namespace inverse::testing
