// SPDX-License-Identifier: LGPL-2.1-or-later
// Cost of an element in an application: system memory in, system memory out. Frames are those of
// the bundled clip, scaled; elements take turns, so that other load affects all alike.
//
// usage: element-bench [--clip FILE] [--sizes 640x480,…] [--frames N] [--rounds N] [--still]
//                      [--ball] [--json FILE] [ELEMENT …]
// --still repeats one frame of the clip; --ball moves a small ball over it.
#include <gst/check/gstharness.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "tests/bench/support/clip_frames.hpp"
#include "tests/bench/support/clip_scenes.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/bench/support/timing.hpp"

namespace {

using inverse::bench::Clock;
using inverse::bench::mean;
using inverse::bench::median;
using inverse::bench::milliseconds;
using inverse::bench::processor_ms;

/// Resident bytes.
double resident() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0;
  statm >> pages >> pages;
  return pages * 4096;
}

struct Size {
  int width, height;
};

std::string caps_of(Size size, const char* format) {
  return std::string("video/x-raw, format=") + format + ", width=" + std::to_string(size.width) +
         ", height=" + std::to_string(size.height) + ", framerate=25/1";
}

struct Figures {
  std::vector<double> wall, processor, device, first;
  std::map<std::string, std::vector<double>> stages;
  double device_bytes = 0, host_bytes = 0;
  int layers = 0;  ///< of indirect light; 0: none
};

void measure(const std::string& line, Size size, const std::vector<GstBuffer*>& frames,
             Figures& figures) {
  const std::string caps = caps_of(size, "NV12");
  const double before = resident();
  const auto start = Clock::now();
  GstHarness* harness = gst_harness_new_parse(line.c_str());
  gst_harness_set_caps_str(harness, caps.c_str(), caps.c_str());
  const std::string factory = line.substr(0, line.find(' '));
  GstElement* element = gst_harness_find_element(harness, factory.c_str());
  for (size_t i = 0; i < frames.size(); ++i) {
    GstBuffer* buffer = gst_buffer_copy_deep(frames[i]);
    GST_BUFFER_PTS(buffer) = i * (GST_SECOND / 25);
    GST_BUFFER_FLAG_UNSET(buffer, GST_BUFFER_FLAG_DISCONT);
    const double processor = processor_ms();
    const auto push = Clock::now();
    gst_harness_push(harness, buffer);
    gst_buffer_unref(gst_harness_pull(harness));
    if (i == 0) figures.first.push_back(milliseconds(Clock::now() - start));
    if (i < 3) continue;  // start, and the first frames of a video
    figures.wall.push_back(milliseconds(Clock::now() - push));
    figures.processor.push_back(processor_ms() - processor);
    GstStructure* stats = nullptr;
    g_object_get(element, "stats", &stats, nullptr);
    for (int field = 0; field < gst_structure_n_fields(stats); ++field) {
      const std::string name = gst_structure_nth_field_name(stats, static_cast<guint>(field));
      gdouble value = 0;
      if (name.size() > 3 && name.ends_with("-ms") && name != "wall-ms" &&
          gst_structure_get_double(stats, name.c_str(), &value))
        (name == "device-ms" ? figures.device : figures.stages[name.substr(0, name.size() - 3)])
            .push_back(value);
    }
    guint64 bytes = 0;
    if (gst_structure_get_uint64(stats, "device-bytes-peak", &bytes))
      figures.device_bytes = static_cast<double>(bytes);
    guint colors = 0;
    if (!gst_structure_get_int(stats, "indirect-layers", &figures.layers) &&
        gst_structure_get_uint(stats, "colors", &colors))
      figures.layers = static_cast<int>(colors);
    gst_structure_free(stats);
  }
  figures.host_bytes = std::max(figures.host_bytes, resident() - before);
  gst_object_unref(element);
  gst_harness_teardown(harness);
}

}  // namespace

int main(int count, char** arguments) {
  gst_init(&count, &arguments);
  std::string clip = "media/clip.webm";
  std::vector<Size> sizes{{320, 240}, {640, 480}, {1280, 720}, {1920, 1080}};
  std::vector<std::string> lines;
  std::string json;
  int frames = 40, rounds = 3;
  bool still = false, ball = false;
  namespace bench = inverse::bench;
  const auto read_sizes = [&sizes](const char* text) {
    sizes.clear();
    std::stringstream list(text);
    for (std::string item; std::getline(list, item, ',');) {
      Size size{};
      if (std::sscanf(item.c_str(), "%dx%d", &size.width, &size.height) != 2) return false;
      sizes.push_back(size);
    }
    return true;
  };
  if (!bench::read({{"--clip", bench::text(clip)},
                    {"--sizes", {true, read_sizes}},
                    {"--frames", bench::integer(frames)},
                    {"--rounds", bench::integer(rounds)},
                    {"--still", bench::flag([&] { still = true; })},
                    {"--ball", bench::flag([&] { ball = true; })},
                    {"--json", bench::text(json)}},
                   count, arguments, "element_bench.cpp", &lines))
    return 2;
  frames = std::max(frames, 4);
  if (lines.empty())
    lines = {"intrinsicdecomp", "intrinsicdecomp adaptive=false", "intrinsicdecompthesis"};
  std::printf(
      "| element | size | wall ms a frame | processor ms | its mean | device ms | ns a pixel "
      "| first frame ms | device bytes a pixel | stages, device ms |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  std::string rows;
  for (const Size& size : sizes) {
    std::fprintf(stderr, "@progress %.3f %dx%d\n",
                 static_cast<double>(&size - sizes.data()) / static_cast<double>(sizes.size()),
                 size.width, size.height);
    auto video =
        inverse::bench::load_clip(clip, caps_of(size, "NV12"), static_cast<size_t>(frames));
    if ((still || ball) && !video.empty())
      for (GstBuffer*& frame : video) gst_buffer_replace(&frame, video.front());
    if (ball)
      for (size_t k = 0; k < video.size(); ++k) {
        GstBuffer* copy = gst_buffer_copy_deep(video[k]);
        inverse::bench::draw_ball(copy, size.width, size.height, static_cast<int>(k));
        gst_buffer_unref(video[k]);
        video[k] = copy;
      }
    if (video.size() < 4) {
      std::fprintf(stderr, "cannot read %s\n", clip.c_str());
      return 1;
    }
    std::vector<Figures> figures(lines.size());
    for (int round = 0; round < rounds; ++round)
      for (size_t i = 0; i < lines.size(); ++i) {
        // The thesis' method takes seconds per frame at large sizes: a few frames suffice.
        const bool slow = lines[i].find("thesis") != std::string::npos;
        const size_t few = slow ? std::min<size_t>(video.size(), 6) : video.size();
        measure(lines[i], size, {video.begin(), video.begin() + static_cast<ptrdiff_t>(few)},
                figures[i]);
      }
    const double pixels = static_cast<double>(size.width) * size.height;
    for (size_t i = 0; i < lines.size(); ++i) {
      const Figures& f = figures[i];
      std::printf("| %s | %dx%d | %.1f | %.1f | %.1f | %.1f | %.0f | %.0f | %.0f | ",
                  lines[i].c_str(), size.width, size.height, median(f.wall), median(f.processor),
                  mean(f.processor),  // has what only some frames do
                  median(f.device), median(f.wall) * 1e6 / pixels, f.first.front(),
                  f.device_bytes / pixels);
      for (const auto& [name, values] : f.stages)
        std::printf("%s %.1f ", name.c_str(), median(values));
      std::printf("|\n");
      std::fflush(stdout);
      char row[512];
      std::snprintf(row, sizeof row,
                    "%s{\"element\": \"%s\", \"width\": %d, \"height\": %d, \"wall_ms\": %.3f, "
                    "\"processor_ms\": %.3f, \"device_ms\": %.3f, \"first_frame_ms\": %.1f, "
                    "\"device_bytes_per_pixel\": %.1f, \"layers\": %d}",
                    rows.empty() ? "" : ",\n", lines[i].c_str(), size.width, size.height,
                    median(f.wall), median(f.processor), median(f.device), f.first.front(),
                    f.device_bytes / pixels, f.layers);
      rows += row;
    }
    for (GstBuffer* buffer : video) gst_buffer_unref(buffer);
  }
  if (!json.empty() && !(std::ofstream(json) << '[' << rows << "]\n").flush()) {
    std::fprintf(stderr, "cannot write %s\n", json.c_str());
    return 1;
  }
  return 0;
}
