// SPDX-License-Identifier: LGPL-2.1-or-later
// Decomposers that remember the scene, by whole lines.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "gst/depth/meta/depth_meta.hpp"
#include "tests/elements/element_test.hpp"
#include "tests/pipeline.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {
namespace {

constexpr const char* kSize = "video/x-raw,width=96,height=72";
constexpr const char* kShown = "video/x-raw,format=RGBA ! appsink name=out sync=false";

/// `change` may change the depth of the frames before the decomposer.
LineResult decompose(const std::string& source, const std::string& settings,
                     const std::function<void(GstInverseDepthMeta&, int)>& change = {},
                     GstStructure** stats = nullptr,
                     const std::string& element = "intrinsicdecomp") {
  int n = 0;
  const std::string line = "rgbdtestsrc is-live=false samples=1 " + source + " ! " + kSize +
                           " ! identity name=before ! " + element +
                           " name=decomposer show=reflectance " + settings + " ! " + kShown;
  return run_line(line, 240, [&](GstElement* pipeline) {
    if (change)
      watch_buffers(find_element(pipeline, "before"), "src", [&, change](GstBuffer* buffer) {
        GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer);
        if (meta) change(*meta, n++);
      });
    if (stats)
      watch_buffers(find_element(pipeline, "out"), "sink", [&, pipeline](GstBuffer*) {
        if (*stats) gst_structure_free(*stats);
        g_object_get(find_element(pipeline, "decomposer"), "stats", stats, nullptr);
      });
  });
}

void set_depth(GstInverseDepthMeta& meta, const std::function<uint16_t(uint16_t)>& change) {
  GstMapInfo map;
  GstBuffer* image = gst_buffer_copy_deep(meta.depth);
  ASSERT_TRUE(gst_buffer_map(image, &map, GST_MAP_READWRITE));
  for (gsize i = 0; i + 1 < map.size; i += 2)
    GST_WRITE_UINT16_LE(map.data + i, change(GST_READ_UINT16_LE(map.data + i)));
  gst_buffer_unmap(image, &map);
  gst_buffer_unref(meta.depth);
  meta.depth = image;
}

/// Where a frame was taken from, and what its camera saw.
struct View {
  std::vector<double> depth;  // meters, row by row
  std::array<double, 12> pose;
  double fx, fy, cx, cy;
  int width, height;
  static View of(const GstInverseDepthMeta& meta) {
    View view{{}, {}, meta.fx, meta.fy, meta.cx, meta.cy, int(meta.width), int(meta.height)};
    std::copy_n(meta.pose, 12, view.pose.begin());
    GstMapInfo map;
    if (!gst_buffer_map(meta.depth, &map, GST_MAP_READ)) return view;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x)
        view.depth.push_back(meta.unit * GST_READ_UINT16_LE(map.data + size_t(y) * meta.stride +
                                                            size_t(2) * size_t(x)));
    gst_buffer_unmap(meta.depth, &map);
    return view;
  }
};

/// Mean over points and frames of how much ln of a shown surface point differs from the frame
/// before, by the true motion.
double flicker(const LineResult& line, const std::vector<View>& views, size_t first) {
  double sum = 0, count = 0;
  const auto shown = [&](size_t n, long x, long y) {
    const uint8_t* pixel = pixel_at(line.frames[n], int(x), int(y), views[n].width);
    return std::log(double(pixel[0] + pixel[1] + pixel[2] + 1));
  };
  for (size_t n = first; n < views.size(); ++n) {
    const View &a = views[n - 1], &b = views[n];
    for (int i = 0; i < a.width * a.height; i += 3) {
      const double z = a.depth[size_t(i)];
      if (!(z > 0)) continue;
      const int x = i % a.width, y = i / a.width;
      const double p[] = {(x - a.cx) / a.fx * z, (y - a.cy) / a.fy * z, z};
      double world[3], q[3] = {};
      for (size_t r = 0; r < 3; ++r)
        world[r] = a.pose[4 * r] * p[0] + a.pose[4 * r + 1] * p[1] + a.pose[4 * r + 2] * p[2] +
                   a.pose[4 * r + 3];
      for (size_t r = 0; r < 3; ++r)
        for (size_t c = 0; c < 3; ++c) q[c] += b.pose[4 * r + c] * (world[r] - b.pose[4 * r + 3]);
      const long u = std::lround(b.fx * q[0] / q[2] + b.cx),
                 v = std::lround(b.fy * q[1] / q[2] + b.cy);
      if (q[2] <= 0 || u < 0 || v < 0 || u >= b.width || v >= b.height) continue;
      if (std::abs(b.depth[size_t(v) * size_t(b.width) + size_t(u)] - q[2]) > 0.03) continue;
      sum += std::abs(shown(n, u, v) - shown(n - 1, x, y));
      ++count;
    }
  }
  return sum / count;
}

constexpr const char* kChapter4 = "intrinsicdecompthesis formulation=chapter4";

class RememberedScene : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Elements, RememberedScene,
                         ::testing::Values("intrinsicdecomp", "globalintrinsic", kChapter4));

// Reflectance of the pictures on the wall is nearer to the truth than without the surfaces.
TEST(Scene, SurfacesTellPaintFromShading) {
  const std::string source = "num-buffers=12 path=wall";
  const LineResult truth = run_line("rgbdtestsrc is-live=false samples=1 show=reflectance " +
                                        source + " ! " + kSize + " ! identity ! " + kShown,
                                    240);
  for (const std::string element : {"intrinsicdecomp", "globalintrinsic"}) {
    // Correlation of ln reflectance in the last frame.
    const auto correlation = [&](const std::string& weight) {
      const LineResult line =
          decompose(source, "tuning=depth-weight=" + weight, {}, nullptr, element);
      EXPECT_EQ(line.frames.size(), 12U) << line.first_error();
      if (line.frames.size() != 12 || truth.frames.size() != 12) return 0.0;
      const std::vector<uint8_t>&found = line.frames.back(), &true_frame = truth.frames.back();
      double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
      for (size_t i = 0; i < found.size(); i += 4, ++n) {
        const double x = std::log(found[i + 1] + 1.0), y = std::log(true_frame[i + 1] + 1.0);
        a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
      }
      return (ab - a * b / n) / std::sqrt((aa - a * a / n) * (bb - b * b / n));
    };
    const double without = correlation("0"), with = correlation("1");
    printf("  %s: correlation %.3f without, %.3f with surfaces\n", element.c_str(), without, with);
    EXPECT_GT(with, without + 0.01) << element;
  }
}

TEST(Scene, FlickersLessWithChapter4OfTheThesis) {
  const auto run = [&](const char* settings) {
    std::vector<View> views;
    const LineResult line = decompose(
        "num-buffers=14 depth-noise=0 speed=3", settings,
        [&](const GstInverseDepthMeta& meta, int) { views.push_back(View::of(meta)); }, nullptr,
        kChapter4);
    EXPECT_EQ(line.frames.size(), 14U) << line.first_error();
    return line.frames.size() == views.size() ? flicker(line, views, 4) : 0;
  };
  const double with = run(""), without = run("scene::remember=false");
  printf("  %.4f with the memory, %.4f without\n", with, without);
  EXPECT_LT(with, 0.75 * without);
}

TEST(Scene, IsOnlyRememberedByChapter4OfTheThesis) {
  const auto last = [](const std::string& settings) {
    const LineResult line =
        decompose("num-buffers=4", settings, {}, nullptr, "intrinsicdecompthesis");
    EXPECT_EQ(line.frames.size(), 4U) << line.first_error();
    return line.frames.empty() ? std::vector<uint8_t>() : line.frames.back();
  };
  EXPECT_EQ(last(""), last("scene::remember=false"));
  EXPECT_NE(last(""), last("scene::remember=true"));
  EXPECT_NE(last("formulation=chapter4"), last("formulation=chapter4 scene::remember=false"));
}

TEST_P(RememberedScene, IsRememberedWhereFramesHaveDepth) {
  GstStructure* stats = nullptr;
  const LineResult with = decompose("num-buffers=8", "", {}, &stats, GetParam()),
                   without =
                       decompose("num-buffers=8", "scene::remember=false", {}, nullptr, GetParam());
  ASSERT_EQ(with.frames.size(), 8U) << with.first_error();
  EXPECT_TRUE(with.warnings.empty()) << with.warnings.front();
  EXPECT_EQ(with.frames[0], without.frames[0]) << "nothing is known of a first frame";
  EXPECT_NE(with.frames[7], without.frames[7]);
  ASSERT_NE(stats, nullptr);
  gboolean found = FALSE;
  guint blocks = 0;
  EXPECT_TRUE(gst_structure_get(stats, "scene-camera-found", G_TYPE_BOOLEAN, &found, "scene-blocks",
                                G_TYPE_UINT, &blocks, nullptr));
  EXPECT_TRUE(found);
  EXPECT_GT(blocks, 500U);
  gst_structure_free(stats);
}

// The poses of a recording serve as well as those that are found.
TEST(Scene, TakesGivenPoses) {
  GstStructure* stats = nullptr;
  const LineResult given =
      decompose("num-buffers=6 path=wall speed=20", "scene::track=false", {}, &stats);
  ASSERT_EQ(given.frames.size(), 6U) << given.first_error();
  EXPECT_TRUE(given.warnings.empty());
  gboolean found = FALSE;
  ASSERT_TRUE(gst_structure_get_boolean(stats, "scene-camera-found", &found));
  EXPECT_TRUE(found);
  gst_structure_free(stats);
}

TEST(Scene, BadDepthIsSaidAndLosesNoFrame) {
  struct Case {
    const char* said;
    std::function<void(GstInverseDepthMeta&, int)> change;
  };
  const auto all = [](uint16_t value) {
    return [value](GstInverseDepthMeta& meta, int) {
      set_depth(meta, [value](uint16_t) { return value; });
    };
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Case cases[] = {
      {"unknown almost everywhere", all(0)},
      {"unknown almost everywhere", all(65535)},
      {"unit of depth", [](GstInverseDepthMeta& meta, int) { meta.unit = 1e-6; }},
      {"unit of depth (depth-unit)", [](GstInverseDepthMeta& meta, int) { meta.unit *= 5; }},
      {"unit of depth (depth-unit)", [](GstInverseDepthMeta& meta, int) { meta.unit /= 5; }},
      {"unit of depth (depth-unit)", [](GstInverseDepthMeta& meta, int) { meta.unit *= 8; }},
      {"unit of depth (depth-unit)", [](GstInverseDepthMeta& meta, int) { meta.unit /= 50; }},
      {"unit of depth", [](GstInverseDepthMeta& meta, int) { meta.unit = 0; }},
      {"unit of depth", [=](GstInverseDepthMeta& meta, int) { meta.unit = nan; }},
      {"focal length", [](GstInverseDepthMeta& meta, int) { meta.fx = 0; }},
      {"focal length", [=](GstInverseDepthMeta& meta, int) { meta.cy = nan; }},
      {"smaller than its meta says", [](GstInverseDepthMeta& meta, int) { meta.height *= 2; }},
      {"smaller than its meta says", [](GstInverseDepthMeta& meta, int) { meta.width = 0; }},
      {"the camera is lost",
       [](GstInverseDepthMeta& meta, int n) {
         if (n > 1) set_depth(meta, [](uint16_t value) { return uint16_t(value / 2); });
       }},
  };
  for (const Case& c : cases) {
    const size_t count = std::string(c.said).find("lost") == std::string::npos ? 5 : 40;
    const LineResult line =
        decompose("num-buffers=" + std::to_string(count), "quality=low", c.change);
    EXPECT_EQ(line.frames.size(), count) << c.said << ": " << line.first_error();
    EXPECT_TRUE(line.eos) << c.said;
    EXPECT_EQ(std::count_if(line.warnings.begin(), line.warnings.end(),
                            [&](const std::string& warning) {
                              return warning.find(c.said) != std::string::npos;
                            }),
              1)
        << c.said << " is said once";
  }
}

TEST(Scene, SaysThatItsMemoryIsFull) {
  const LineResult line =
      decompose("num-buffers=8", "scene::memory-limit=8 scene::voxel-size=0.002");
  EXPECT_EQ(line.frames.size(), 8U) << line.first_error();
  ASSERT_EQ(line.warnings.size(), 1U) << ::testing::PrintToString(line.warnings);
  EXPECT_NE(line.warnings[0].find("scene::memory-limit"), std::string::npos) << line.warnings[0];
}

/// Runs `frames` frames with a scene file; what `stats` say last.
struct Found {
  LineResult line;
  guint blocks = 0;
  gboolean camera = FALSE;
};
Found with_file(const std::string& source, const std::string& settings) {
  GstStructure* stats = nullptr;
  Found found{decompose(source, settings, {}, &stats)};
  if (!stats) return found;
  gst_structure_get(stats, "scene-blocks", G_TYPE_UINT, &found.blocks, "scene-camera-found",
                    G_TYPE_BOOLEAN, &found.camera, nullptr);
  gst_structure_free(stats);
  return found;
}

TEST(Scene, IsWrittenAndKnownFromAFile) {
  const TemporaryFolder folder;
  const Found made = with_file("num-buffers=12", "scene::location=" + folder / "room.scene");
  ASSERT_EQ(made.line.frames.size(), 12U) << made.line.first_error();
  EXPECT_TRUE(made.line.warnings.empty()) << made.line.warnings.front();
  // Where the camera was before; its place is found in the scene.
  const Found known = with_file("num-buffers=14", "scene::load=" + folder / "room.scene");
  EXPECT_TRUE(known.line.warnings.empty()) << known.line.warnings.front();
  EXPECT_TRUE(known.camera);
  EXPECT_GE(known.blocks, made.blocks);
  const Found mesh = with_file("num-buffers=4", "scene::location=" + folder / "room.ply");
  EXPECT_TRUE(mesh.line.warnings.empty()) << mesh.line.warnings.front();
  EXPECT_GT(std::filesystem::file_size(folder / "room.ply"), 100'000U);
  // Faults are one warning each, and lose no frame.
  folder.write("bad.scene", "no scene");
  for (const auto& [settings, said] : std::initializer_list<std::pair<std::string, const char*>>{
           {"scene::load=" + folder / "missing.scene", "missing.scene cannot be read"},
           {"scene::load=" + folder / "bad.scene", "no scene that this version reads"},
           {"scene::voxel-size=0.02 scene::load=" + folder / "room.scene", "voxels have a side of"},
           {"scene::location=" + folder / "room.txt", "name it .ply"},
           {"scene::location=" + folder / "no/room.ply", "cannot be written into the folder"}}) {
    const Found bad = with_file("num-buffers=4", settings);
    EXPECT_EQ(bad.line.frames.size(), 4U) << settings << bad.line.first_error();
    ASSERT_FALSE(bad.line.warnings.empty()) << settings;
    EXPECT_NE(bad.line.warnings[0].find(said), std::string::npos) << bad.line.warnings[0];
    // At the start, and at the end what is not written then.
    EXPECT_EQ(bad.line.warnings.size(), settings.starts_with("scene::location") ? 2U : 1U);
  }
}

TEST(Scene, FilesNeedDepth) {
  for (const char* setting :
       {"scene::load=/nowhere/room.scene", "scene::location=/nowhere/room.ply"}) {
    const LineResult line = run_line(
        std::string(
            "videotestsrc num-buffers=4 ! video/x-raw,width=64,height=48 ! intrinsicdecomp ") +
        setting + " ! appsink name=out sync=false");
    EXPECT_EQ(line.frames.size(), 4U) << line.first_error();
    ASSERT_EQ(line.warnings.size(), 1U) << setting;
    EXPECT_NE(line.warnings[0].find("without depth"), std::string::npos) << line.warnings[0];
  }
}

TEST(Scene, IsSavedOnRequest) {
  const TemporaryFolder folder;
  int n = 0;
  gboolean early = TRUE, other = TRUE, now = FALSE;
  const LineResult line = run_line(
      std::string("rgbdtestsrc is-live=false samples=1 num-buffers=12 ! ") + kSize +
          " ! identity name=before ! intrinsicdecomp name=decomposer show=reflectance ! " + kShown,
      240, [&](GstElement* pipeline) {
        watch_buffers(find_element(pipeline, "before"), "src", [&, pipeline](GstBuffer*) {
          GstElement* decomposer = find_element(pipeline, "decomposer");
          const auto save = [&](const std::string& name, gboolean* done) {
            g_signal_emit_by_name(decomposer, "save-scene", (folder / name).c_str(), done);
          };
          if (n == 0) save("early.ply", &early);
          if (n == 6) save("room.doc", &other);
          if (n == 6) save("room.ply", &now);
          ++n;
        });
      });
  EXPECT_EQ(line.frames.size(), 12U) << line.first_error();
  EXPECT_FALSE(early) << "nothing is remembered yet";
  EXPECT_FALSE(other);
  EXPECT_TRUE(now);
  EXPECT_EQ(line.warnings.size(), 2U);
  EXPECT_EQ(std::count(line.messages.begin(), line.messages.end(), "scene-saved"), 1);
  EXPECT_GT(std::filesystem::file_size(folder / "room.ply"), 100'000U);
}

// After the end of the stream no frame comes; the element writes it when it stops.
TEST(Scene, IsSavedOnRequestAfterTheEnd) {
  const TemporaryFolder folder;
  static std::string path;
  static gboolean asked;
  path = folder / "room.ply";
  asked = FALSE;
  const LineResult line =
      run_line(std::string("rgbdtestsrc is-live=false samples=1 num-buffers=6 ! ") + kSize +
                   " ! intrinsicdecomp name=decomposer scene::location=" + folder / "end.scene" +
                   " ! " + kShown,
               240, [&](GstElement* pipeline) {
                 GstElement* decomposer = find_element(pipeline, "decomposer");
                 GstPad* pad = gst_element_get_static_pad(find_element(pipeline, "out"), "sink");
                 gst_pad_add_probe(
                     pad, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM,
                     [](GstPad*, GstPadProbeInfo* info, gpointer element) {
                       if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_EOS)
                         g_signal_emit_by_name(element, "save-scene", path.c_str(), &asked);
                       return GST_PAD_PROBE_OK;
                     },
                     decomposer, nullptr);
                 gst_object_unref(pad);
               });
  EXPECT_EQ(line.frames.size(), 6U) << line.first_error();
  EXPECT_TRUE(asked);
  EXPECT_GT(std::filesystem::file_size(path), 10'000U);
  EXPECT_GT(std::filesystem::file_size(folder / "end.scene"), 10'000U);
}

TEST(Scene, AHugeFileThatIsNoSceneIsNotRead) {
  const TemporaryFolder folder;
  for (const std::string begin : {"", "gst-inverse scene 2\n"}) {
    const std::string path = folder.write("huge.scene", begin);
    std::filesystem::resize_file(path, uint64_t{20} << 30);  // without blocks on the disk
    const Found bad = with_file("num-buffers=4", "scene::load=" + path);
    EXPECT_EQ(bad.line.frames.size(), 4U) << bad.line.first_error();
    ASSERT_EQ(bad.line.warnings.size(), 1U);
    EXPECT_NE(bad.line.warnings[0].find(begin.empty() ? "no scene" : "larger than"),
              std::string::npos)
        << bad.line.warnings[0];
  }
}

// So that the file is there before the stream ends.
TEST(Scene, IsSavedOnRequestWhenThePictureRepeats) {
  constexpr int kFrames = 120;
  const TemporaryFolder folder;
  int n = 0;
  guint64 reused = 0;
  gboolean asked = FALSE;
  const LineResult line = run_line(
      "rgbdtestsrc is-live=false samples=1 path=still num-buffers=" + std::to_string(kFrames) +
          " ! " + kSize + " ! identity name=before ! intrinsicdecomp name=decomposer ! " + kShown,
      240, [&](GstElement* pipeline) {
        watch_buffers(find_element(pipeline, "before"), "src", [&, pipeline](GstBuffer*) {
          if (++n != kFrames - 4) return;
          GstElement* decomposer = find_element(pipeline, "decomposer");
          GstStructure* stats = nullptr;
          g_object_get(decomposer, "stats", &stats, nullptr);
          gst_structure_get_uint64(stats, "frames-reused", &reused);
          gst_structure_free(stats);
          g_signal_emit_by_name(decomposer, "save-scene", (folder / "room.ply").c_str(), &asked);
        });
      });
  EXPECT_EQ(line.frames.size(), size_t{kFrames}) << line.first_error();
  EXPECT_GT(reused, 0U);
  EXPECT_TRUE(asked);
  EXPECT_EQ(std::ranges::count(line.messages, "scene-saved"), 1);
}

// A seek goes elsewhere in the same scene; a new stream, or who asks for it, begins another one.
TEST(Scene, OutlivesASeek) {
  struct Case {
    bool kept;
    std::function<void(GstElement*)> end;
  };
  const auto push = [](GstElement* line, std::initializer_list<GstEvent*> events) {
    GstPad* pad = gst_element_get_static_pad(find_element(line, "before"), "src");
    for (GstEvent* event : events) gst_pad_push_event(pad, event);
    gst_object_unref(pad);
  };
  const auto segment = [] {
    GstSegment time;
    gst_segment_init(&time, GST_FORMAT_TIME);
    return gst_event_new_segment(&time);
  };
  const Case cases[] = {
      {true,
       [&](GstElement* line) {
         push(line, {gst_event_new_flush_start(), gst_event_new_flush_stop(TRUE), segment()});
       }},
      {false,
       [&](GstElement* line) {
         push(line, {gst_event_new_stream_start("other"), segment()});
       }},
      {false,
       [](GstElement* line) {
         g_signal_emit_by_name(find_element(line, "decomposer"), "forget-scene");
       }},
  };
  for (size_t i = 0; i < std::size(cases); ++i) {
    int n = 0;
    std::vector<guint> blocks;
    const LineResult line = run_line(
        std::string("rgbdtestsrc is-live=false samples=1 num-buffers=24 speed=3 ! ") + kSize +
            " ! identity name=before ! intrinsicdecomp name=decomposer show=reflectance "
            "scene::max-depth=3 ! " +
            kShown,
        240, [&](GstElement* pipeline) {
          watch_buffers(find_element(pipeline, "before"), "src", [&, pipeline](GstBuffer*) {
            if (n++ == 12) cases[i].end(pipeline);
          });
          watch_buffers(find_element(pipeline, "out"), "sink", [&, pipeline](GstBuffer*) {
            GstStructure* stats = nullptr;
            g_object_get(find_element(pipeline, "decomposer"), "stats", &stats, nullptr);
            guint now = 0;
            if (stats && gst_structure_get_uint(stats, "scene-blocks", &now)) blocks.push_back(now);
            if (stats) gst_structure_free(stats);
          });
        });
    EXPECT_GE(line.frames.size(), 20U) << i << line.first_error();
    EXPECT_TRUE(line.warnings.empty()) << i << line.warnings.front();
    const bool falls = !std::ranges::is_sorted(blocks);
    EXPECT_EQ(falls, !cases[i].kept) << i;
  }
}

// Sizes and settings that change while it runs forget the scene and lose no frame.
TEST(Scene, ChangesWhileItRuns) {
  int n = 0;
  const LineResult line = run_line(
      std::string("rgbdtestsrc is-live=false samples=1 num-buffers=16 ! ") + kSize +
          " ! identity name=before ! intrinsicdecomp name=decomposer show=reflectance ! " + kShown,
      240, [&](GstElement* pipeline) {
        watch_buffers(find_element(pipeline, "before"), "src", [&, pipeline](GstBuffer* buffer) {
          GstElement* decomposer = find_element(pipeline, "decomposer");
          GstInverseDepthMeta* meta = gst_buffer_get_inverse_depth_meta(buffer);
          if (n >= 4 && n < 8) meta->height /= 2;
          if (n == 8)
            gst_child_proxy_set(GST_CHILD_PROXY(decomposer), "scene::voxel-size", 0.02, nullptr);
          if (n == 10)
            gst_child_proxy_set(GST_CHILD_PROXY(decomposer), "scene::remember", FALSE, nullptr);
          if (n == 12)
            gst_child_proxy_set(GST_CHILD_PROXY(decomposer), "scene::remember", TRUE, nullptr);
          if (n == 14)
            gst_child_proxy_set(GST_CHILD_PROXY(decomposer), "scene::track", FALSE, nullptr);
          ++n;
        });
      });
  EXPECT_EQ(line.frames.size(), 16U) << line.first_error();
  EXPECT_TRUE(line.warnings.empty()) << line.warnings.front();
}

}  // namespace
}  // namespace inverse::testing
