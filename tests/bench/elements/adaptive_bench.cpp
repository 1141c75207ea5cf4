// SPDX-License-Identifier: LGPL-2.1-or-later
// Time saved by skipping in intrinsicdecomp or globalintrinsic: whole elements, system memory in
// and out, videos of some length. Every setting processes each frame in turn, in alternating order,
// so that other load affects all settings alike.
//
// usage: adaptive-bench [--element NAME] [--size 640x480] [--frames N] [--unmeasured N]
//                       [--whole N] [--brief] [--json FILE]
// Scenes with much to skip ignore the first frames (--unmeasured, 24), while solves converge.
// Scenes with nothing to skip show --whole frames, for an accurate ratio; --brief leaves them out.
#include <gst/check/gstharness.h>

#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/bench/support/clip_frames.hpp"
#include "tests/bench/support/clip_scenes.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/bench/support/timing.hpp"

namespace {

using inverse::bench::Clock;
using inverse::bench::median;
using inverse::bench::milliseconds;
using inverse::bench::processor_ms;

constexpr int kWarmUp = 24;  // not measured

struct Size {
  int width, height;
};

struct Setting {
  std::string name, line;
};

/// An element under measurement.
struct Run {
  GstHarness* harness;
  std::vector<double> wall, processor;
};

struct Scene {
  const char* name;
  bool brief;                           ///< much can be skipped
  void (*draw)(GstBuffer*, Size, int);  ///< draws over the first frame of the clip; null: the clip
                                        ///< plays
};

constexpr Scene kScenes[] = {
    {"frames come again", true, [](GstBuffer*, Size, int) {}},
    {"small ball", true,
     [](GstBuffer* b, Size s, int k) { inverse::bench::draw_ball(b, s.width, s.height, k); }},
    {"camera noise", false,
     [](GstBuffer* b, Size s, int k) {
       inverse::bench::add_noise(b, s.width, s.height, static_cast<unsigned>(k));
     }},
    {"moving light", false, nullptr}};

void push(Run& run, GstBuffer* frame, int number, bool measured) {
  GstBuffer* buffer = gst_buffer_copy_deep(frame);
  GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(number) * (GST_SECOND / 25);
  GST_BUFFER_FLAG_UNSET(buffer, GST_BUFFER_FLAG_DISCONT);
  const double processor = processor_ms();
  const auto start = Clock::now();
  gst_harness_push(run.harness, buffer);
  gst_buffer_unref(gst_harness_pull(run.harness));
  if (!measured) return;
  run.wall.push_back(milliseconds(Clock::now() - start));
  run.processor.push_back(processor_ms() - processor);
}

std::string list(const std::vector<double>& values) {
  std::string text;
  char number[32];
  for (const double v : values) {
    std::snprintf(number, sizeof number, "%s%.3f", text.empty() ? "" : ", ", v);
    text += number;
  }
  return "[" + text + "]";
}

/// Number of frames: if much can be skipped, if nothing can, and unmeasured ones if much can.
struct Frames {
  int all = 48, whole = 0, unmeasured = kWarmUp;
};

/// Rows of JSON, one for each setting.
std::string measure(const Scene& scene, const std::string& element, Size size,
                    const std::string& caps, Frames frames, const std::vector<GstBuffer*>& clip,
                    const std::vector<Setting>& all) {
  std::vector<Run> runs;
  for (const Setting& setting : all) {
    GstHarness* harness = gst_harness_new_parse(setting.line.c_str());
    gst_harness_set_caps_str(harness, caps.c_str(), caps.c_str());
    runs.push_back({harness, {}, {}});
  }
  const int unmeasured = scene.brief ? frames.unmeasured : kWarmUp;
  const int count = scene.brief ? frames.all : std::max(frames.all, frames.whole);
  for (int k = 0; k < count; ++k) {
    const size_t shown = scene.draw ? 0 : static_cast<size_t>(k) % clip.size();
    GstBuffer* frame = gst_buffer_copy_deep(clip[shown]);
    if (scene.draw) scene.draw(frame, size, k);
    for (size_t i = 0; i < runs.size(); ++i)
      push(runs[k % 2 ? runs.size() - 1 - i : i], frame, k, k >= unmeasured);
    gst_buffer_unref(frame);
  }
  std::string rows;
  for (size_t i = 0; i < all.size(); ++i) {
    std::printf("| %s | %s | %dx%d | %s | %.1f | %.1f |\n", element.c_str(), scene.name, size.width,
                size.height, all[i].name.c_str(), median(runs[i].wall), median(runs[i].processor));
    rows += std::string(i > 0 ? ",\n" : "") + "{\"element\": \"" + element + "\", \"scene\": \"" +
            scene.name + "\", \"width\": " + std::to_string(size.width) +
            ", \"height\": " + std::to_string(size.height) +
            ", \"frames\": " + std::to_string(count) + ", \"setting\": \"" + all[i].name +
            "\", \"wall_ms\": " + list(runs[i].wall) +
            ", \"processor_ms\": " + list(runs[i].processor) + "}";
    gst_harness_teardown(runs[i].harness);
  }
  std::fflush(stdout);
  return rows;
}

}  // namespace

int main(int count, char** arguments) {
  gst_init(&count, &arguments);
  std::string element = "intrinsicdecomp", json;
  Size size{640, 480};
  Frames frames;
  bool brief = false;
  namespace bench = inverse::bench;
  const auto read_size = [&size](const char* text) {
    return std::sscanf(text, "%dx%d", &size.width, &size.height) == 2;
  };
  if (!bench::read({{"--element", bench::text(element)},
                    {"--size", {true, read_size}},
                    {"--frames", bench::integer(frames.all)},
                    {"--unmeasured", bench::integer(frames.unmeasured)},
                    {"--whole", bench::integer(frames.whole)},
                    {"--brief", bench::flag([&] { brief = true; })},
                    {"--json", bench::text(json)}},
                   count, arguments, "adaptive_bench.cpp"))
    return 2;
  frames.all = std::max(frames.all, std::max(frames.unmeasured, kWarmUp) + 4);
  GstElementFactory* factory = gst_element_factory_find(element.c_str());
  if (!factory) return std::fprintf(stderr, "there is no element %s\n", element.c_str()), 1;
  gst_object_unref(factory);
  const std::string caps = "video/x-raw, format=NV12, width=" + std::to_string(size.width) +
                           ", height=" + std::to_string(size.height) + ", framerate=25/1";
  const auto video = bench::load_clip("media/clip.webm", caps,
                                      static_cast<size_t>(std::max(frames.all, frames.whole)));
  if (video.empty()) return std::fprintf(stderr, "cannot read media/clip.webm\n"), 1;
  std::printf(
      "| element | scene | size | adaptive | wall ms a frame | processor ms "
      "|\n|---|---|---|---|---|---|\n");
  const std::vector<Setting> all{{"off", element + " adaptive=false"}, {"on", element}};
  std::string rows;
  for (const Scene& scene : kScenes) {
    if (brief && !scene.brief) continue;
    std::fprintf(stderr, "@progress %.3f %s\n",
                 static_cast<double>(&scene - kScenes) / static_cast<double>(std::size(kScenes)),
                 scene.name);
    rows += (rows.empty() ? "" : ",\n") + measure(scene, element, size, caps, frames, video, all);
  }
  for (GstBuffer* buffer : video) gst_buffer_unref(buffer);
  if (!json.empty() && !(std::ofstream(json) << "[" << rows << "]\n").flush()) {
    std::fprintf(stderr, "cannot write %s\n", json.c_str());
    return 1;
  }
  return 0;
}
