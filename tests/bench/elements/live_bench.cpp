// SPDX-License-Identifier: LGPL-2.1-or-later
// Rate control under a varying load: frames of the bundled clip at a camera's rate; during the
// second third, other threads keep the processor busy. Runs without and with a target alternate.
//
// usage: live-bench [--clip FILE] [--size 640x480] [--fps F] [--seconds S] [--threads N] [--rounds
// N]
//                   [--csv FILE] [--svg FILE] [ELEMENT]
// --fps 0 (the default) takes what leaves frames 1.5 times the time that they take unloaded.
#include <gst/check/gstharness.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/bench/support/clip_frames.hpp"
#include "tests/bench/support/timing.hpp"

namespace {

using inverse::bench::Clock;
using inverse::bench::median;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Threads that use processor time while they exist.
class Load {
 public:
  explicit Load(int threads) {
    for (int i = 0; i < threads; ++i)
      threads_.emplace_back([this] {
        while (!stop_.load(std::memory_order_relaxed)) {
        }
      });
  }
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;
  ~Load() {
    stop_ = true;
    for (auto& thread : threads_) thread.join();
  }

 private:
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

struct Frame {
  double time, took_ms;
  bool loaded;
  guint level = 0;
  guint64 moves = 0;
};

struct Setting {
  std::string element, caps;
  double fps, seconds;
  int threads;
};

/// A stream of `seconds`; a frame that is not finished when the next is due delays it.
std::vector<Frame> run(const Setting& setting, const std::vector<GstBuffer*>& video, bool traded) {
  GstHarness* harness = gst_harness_new_parse(setting.element.c_str());
  gst_harness_set_caps_str(harness, setting.caps.c_str(), setting.caps.c_str());
  const std::string factory = setting.element.substr(0, setting.element.find(' '));
  GstElement* element = gst_harness_find_element(harness, factory.c_str());
  if (traded) g_object_set(element, "target-fps", setting.fps, nullptr);
  const auto start = Clock::now();
  std::vector<Frame> frames;
  std::optional<Load> load;
  for (size_t i = 0; seconds_since(start) < setting.seconds; ++i) {
    const double now = seconds_since(start);
    const bool loaded = now > setting.seconds / 3 && now < 2 * setting.seconds / 3;
    if (loaded && !load) load.emplace(setting.threads);
    if (!loaded) load.reset();
    GstBuffer* buffer = gst_buffer_copy_deep(video[i % video.size()]);
    GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(now * GST_SECOND);
    GST_BUFFER_FLAG_UNSET(buffer, GST_BUFFER_FLAG_DISCONT);
    const auto push = Clock::now();
    gst_harness_push(harness, buffer);
    gst_buffer_unref(gst_harness_pull(harness));
    Frame frame{now, 1e3 * seconds_since(push), loaded};
    GstStructure* stats = nullptr;
    g_object_get(element, "stats", &stats, nullptr);
    gst_structure_get(stats, "live-level", G_TYPE_UINT, &frame.level, "live-moves", G_TYPE_UINT64,
                      &frame.moves, nullptr);
    gst_structure_free(stats);
    frames.push_back(frame);
    std::this_thread::sleep_until(push + std::chrono::duration<double>(1 / setting.fps));
  }
  gst_object_unref(element);
  gst_harness_teardown(harness);
  return frames;
}

void summarize(const char* name, const std::vector<Frame>& frames, double budget_ms) {
  for (const bool loaded : {false, true}) {
    std::vector<double> took;
    size_t over = 0;
    for (const Frame& frame : frames)
      if (frame.loaded == loaded) took.push_back(frame.took_ms), over += frame.took_ms > budget_ms;
    std::printf(
        "| %s | %s | %.1f | %.0f %% | ", name, loaded ? "busy" : "idle", median(took),
        took.empty() ? 0 : 100. * static_cast<double>(over) / static_cast<double>(took.size()));
    std::printf("%llu |\n", static_cast<unsigned long long>(frames.back().moves));
  }
}

void write_csv(const std::string& path, const std::vector<Frame>& without,
               const std::vector<Frame>& with) {
  std::ofstream csv(path);
  csv << "run,seconds,ms,busy,level\n";
  for (const auto* frames : {&without, &with})
    for (const Frame& frame : *frames)
      csv << (frames == &with ? "target" : "free") << ',' << frame.time << ',' << frame.took_ms
          << ',' << frame.loaded << ',' << frame.level << '\n';
}

void write_svg(const std::string& path, const std::vector<Frame>& without,
               const std::vector<Frame>& with, const Setting& setting) {
  constexpr double kWidth = 720, kTimes = 240, kHeight = 380, kMargin = 48;
  const double budget = 1e3 / setting.fps, max_ms = 4 * budget;
  const auto x = [&](double s) { return kMargin + (kWidth - 1.5 * kMargin) * s / setting.seconds; };
  const auto y = [&](double ms) { return kTimes - (kTimes - 30) * std::min(ms, max_ms) / max_ms; };
  guint top = 1;
  for (const Frame& frame : with) top = std::max(top, frame.level);
  const auto level_y = [&](guint level) {
    return kHeight - 24 - (kHeight - kTimes - 60) * static_cast<double>(level) / top;
  };
  std::ofstream svg(path);
  svg << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 " << kWidth << ' ' << kHeight
      << "' font-family='sans-serif' font-size='12'>\n<rect width='100%' height='100%' "
         "fill='white'/>\n";
  svg << "<rect x='" << x(setting.seconds / 3) << "' y='20' width='"
      << x(2 * setting.seconds / 3) - x(setting.seconds / 3) << "' height='" << kHeight - 40
      << "' fill='#f3ead8'/><text x='" << x(setting.seconds / 3) + 6 << "' y='34'>"
      << setting.threads << " busy threads</text>\n";
  svg << "<path d='M" << kMargin << ' ' << y(budget) << 'H' << x(setting.seconds)
      << "' stroke='#c33' stroke-dasharray='4 3'/><text x='4' y='" << y(budget) + 4 << "'>"
      << static_cast<int>(budget + 0.5) << " ms</text><text x='4' y='" << y(0) + 4
      << "'>0 ms</text>\n";
  const auto curve = [&](const std::vector<Frame>& frames, const char* color) {
    svg << "<polyline fill='none' stroke='" << color << "' points='";
    for (const Frame& frame : frames) svg << x(frame.time) << ',' << y(frame.took_ms) << ' ';
    svg << "'/>\n";
  };
  curve(without, "#bbb");
  curve(with, "#1b6ca8");
  svg << "<polyline fill='none' stroke='#1b6ca8' stroke-width='2' points='";
  for (size_t i = 0; i < with.size(); ++i) {
    if (i > 0) svg << x(with[i].time) << ',' << level_y(with[i - 1].level) << ' ';
    svg << x(with[i].time) << ',' << level_y(with[i].level) << ' ';
  }
  svg << "'/>\n";
  for (guint level = 0; level <= top; ++level)
    svg << "<text x='4' y='" << level_y(level) + 4 << "'>level " << level << "</text>\n";
  svg << "<text x='" << kWidth / 2 << "' y='14' fill='#1b6ca8'>target-fps=" << setting.fps
      << "</text><text x='" << kWidth / 2 + 150
      << "' y='14' fill='#999'>no target</text>\n</svg>\n";
}

}  // namespace

int main(int count, char** arguments) {
  gst_init(&count, &arguments);
  std::string clip = "media/clip.webm", size = "640x480", csv, svg;
  Setting setting{"intrinsicdecomp", {}, 0, 45, 4};
  int rounds = 1;
  for (int i = 1; i < count; ++i) {
    const std::string argument = arguments[i];
    const auto next = [&] { return std::string(++i < count ? arguments[i] : ""); };
    if (argument == "--clip")
      clip = next();
    else if (argument == "--size")
      size = next();
    else if (argument == "--fps")
      setting.fps = std::stod(next());
    else if (argument == "--seconds")
      setting.seconds = std::max(6., std::stod(next()));
    else if (argument == "--threads")
      setting.threads = std::stoi(next());
    else if (argument == "--rounds")
      rounds = std::max(1, std::stoi(next()));
    else if (argument == "--csv")
      csv = next();
    else if (argument == "--svg")
      svg = next();
    else
      setting.element = argument;
  }
  int width = 0, height = 0;
  if (std::sscanf(size.c_str(), "%dx%d", &width, &height) != 2) return 2;
  setting.caps = "video/x-raw, format=NV12, width=" + std::to_string(width) +
                 ", height=" + std::to_string(height) + ", framerate=25/1";
  const auto video = inverse::bench::load_clip(clip, setting.caps);
  if (video.size() < 4) {
    std::fprintf(stderr, "cannot read %s\n", clip.c_str());
    return 1;
  }
  if (setting.fps <= 0) {
    Setting probe = setting;
    probe.fps = 1000, probe.seconds = 6, probe.threads = 0;
    std::vector<double> took;
    for (const Frame& frame : run(probe, video, false)) took.push_back(frame.took_ms);
    setting.fps = 1e3 / (1.5 * median(took));
  }
  const double budget = 1e3 / setting.fps;
  std::printf(
      "%s, %s, %.1f frames a second: %.1f ms each\n"
      "| | others | median ms | over budget | changes of level so far |\n|---|---|---|---|---|\n",
      setting.element.c_str(), size.c_str(), setting.fps, budget);
  for (int round = 0; round < rounds; ++round) {
    const auto without = run(setting, video, false);
    summarize("no target", without, budget);
    const auto with = run(setting, video, true);
    summarize("target-fps", with, budget);
    if (!csv.empty()) write_csv(csv, without, with);
    if (!svg.empty()) write_svg(svg, without, with, setting);
  }
  for (GstBuffer* buffer : video) gst_buffer_unref(buffer);
  return 0;
}
