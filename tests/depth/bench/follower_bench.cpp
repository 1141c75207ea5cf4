// SPDX-License-Identifier: LGPL-2.1-or-later
// Our tracking and volume beside those of OpenCV's module rgbd, on the same frames.
//
//   follower-bench [--frames N] [--size WxH] [--rate FPS] [--noise N] [--voxel M] [--true-poses]
//                  [--only NAME]… orbit|wall|FOLDER…
//
// Sources are those of tracking-bench (rgbd_source.hpp). All followers take turns on each frame, in
// one process; OpenCV runs on the CPU, without OpenCL. Prints a table. Root of the mean square
// distance to the true place, mm (the first pose is given), the largest one, and that of the last
// frame; frames in which the camera was lost. The surface that each one has at the end, from the
// true pose of each eighth frame: mean error of depth, mm, of pixels that are off by less than
// 5 cm; share of those that are off by more; share of pixels up to 5 m that have a depth at all.
// Medians of ms a frame: by the clock, of all processors, and by part. MB that are allocated at the
// end. With --true-poses nothing is tracked: errors of fusion alone.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "follower.hpp"
#include "tests/bench/support/timing.hpp"

namespace inverse::bench {
namespace {

constexpr int kViewEvery = 8;
constexpr double kMaxDepth = 5, kOff = 0.05;  // meters

struct Settings : RgbdSettings {
  double voxel = 0.01;
  bool tracked = true;
  std::vector<std::string> only;
};

/// What the surface is compared with.
struct TrueView {
  Pose pose;
  std::vector<float> depth;
};

struct Row {
  std::string name;
  std::unique_ptr<Follower> follower;
  double squares = 0, most = 0, last = 0;
  int lost = 0;
  std::vector<double> wall, processor, parts[3];
};

void widen(Setting& setting, const TrueView& view) {
  const auto rows = rows_of(view.pose);
  const Lens& lens = setting.lens;
  for (size_t i = 0; i < view.depth.size(); ++i) {
    const double z = double{view.depth[i]};
    if (!(z > 0 && z <= kMaxDepth)) continue;
    const double p[] = {(double(i % setting.extent.width) - double{lens.cx}) / double{lens.fx} * z,
                        (double(i / setting.extent.width) - double{lens.cy}) / double{lens.fy} * z,
                        z};
    for (size_t r = 0; r < 3; ++r) {
      constexpr double kMargin = 0.1;  // meters
      const double at =
          rows[4 * r] * p[0] + rows[4 * r + 1] * p[1] + rows[4 * r + 2] * p[2] + rows[4 * r + 3];
      setting.low[r] = std::min(setting.low[r], at - kMargin);
      setting.high[r] = std::max(setting.high[r], at + kMargin);
    }
  }
}

Seen seen_of(const Lab& lab, RgbdFrame frame) {
  Seen seen{std::move(frame), {}, {}};
  seen.depth = lab.download(seen.frame.depth);
  seen.picture = lab.download(seen.frame.picture);
  for (size_t i = 3; i < seen.picture.size(); i += 4) seen.picture[i] = 1;
  return seen;
}

void step(const Lab& lab, Row& row, const Seen& seen, int n) {
  const auto start = Clock::now();
  const double processor = processor_ms();
  const bool found = row.follower->follow(lab, seen);
  if (n >= 3) {  // kernels are built by then
    row.wall.push_back(milliseconds(Clock::now() - start));
    row.processor.push_back(processor_ms() - processor);
    for (size_t i = 0; i < std::size(row.parts); ++i)
      row.parts[i].push_back(row.follower->parts[i]);
  }
  row.lost += !found;
  const Pose pose = row.follower->pose(lab);
  double square = 0;
  for (size_t c = 0; c < 3; ++c)
    square += std::pow(double{pose.place[c]} - double{seen.frame.pose.place[c]}, 2);
  row.squares += square;
  row.last = std::sqrt(square);
  row.most = std::max(row.most, row.last);
}

void print(const Lab& lab, Row& row, int frames, const std::vector<TrueView>& views) {
  double error = 0, near = 0, off = 0, all = 0;
  for (const TrueView& view : views) {
    const std::vector<float> depth = row.follower->depth_from(lab, view.pose);
    for (size_t i = 0; i < depth.size(); ++i) {
      const double truth = double{view.depth[i]}, difference = std::abs(double{depth[i]} - truth);
      if (!(truth > 0 && truth <= kMaxDepth)) continue;
      ++all;
      if (!(depth[i] > 0)) continue;
      const bool close = difference < kOff;
      near += close;
      off += !close;
      if (close) error += difference;
    }
  }
  printf("| %s | %d | %.1f | %.1f | %.1f | %d |", row.name.c_str(), frames,
         1000 * std::sqrt(row.squares / frames), 1000 * row.most, 1000 * row.last, row.lost);
  if (all > 0)
    printf(" %.1f | %.1f | %.1f |", 1000 * error / near, 100 * off / (near + off),
           100 * (near + off) / all);
  else
    printf(" – | – | – |");
  printf(" %.0f | %.0f | %.0f | %.0f | %.0f | %.0f |\n", median(row.wall), median(row.processor),
         median(row.parts[0]), median(row.parts[1]), median(row.parts[2]),
         double(row.follower->bytes) / 1e6);
  fflush(stdout);
}

void compare(const Lab& lab, const std::string& name, RgbdSource& source,
             const Settings& settings) {
  Setting setting{source.extent(), source.lens(),   {}, {1e9, 1e9, 1e9}, {-1e9, -1e9, -1e9},
                  settings.voxel,  settings.tracked};
  std::vector<TrueView> views;
  for (int n = 0; n < source.frames(); n += kViewEvery) {
    RgbdFrame frame = source.frame(lab, n);
    views.push_back({frame.pose, std::move(frame.true_depth)});
    widen(setting, views.back());
  }
  setting.first = views[0].pose;
  std::vector<Row> rows;
  for (const auto& followers : {own_followers(), opencv_followers()})
    for (const NamedFollower& named : followers) {
      const auto& only = settings.only;
      if (!only.empty() && std::find(only.begin(), only.end(), named.name) == only.end()) continue;
      if (auto follower = named.make(lab, setting))
        rows.push_back({.name = named.name, .follower = std::move(follower)});
    }
  for (int n = 0; n < source.frames(); ++n) {
    const Seen seen = seen_of(lab, source.frame(lab, n));
    for (Row& row : rows) step(lab, row, seen, n);
  }
  printf("\n%s%s\n\n", name.c_str(), settings.tracked ? "" : ", true poses");
  printf(
      "| | frames | rms mm | max | last | lost | surface mm | off %% | covered %% | ms | "
      "processors | following | fusion | rendering | MB |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (Row& row : rows) print(lab, row, source.frames(), views);
}

int run(int count, char** arguments) {
  Settings settings;
  std::vector<std::string> names;
  const Options options =
      rgbd_options(settings, {{"--voxel", number(settings.voxel)},
                              {"--true-poses", flag([&] { settings.tracked = false; })},
                              {"--only", {true, [&](const char* value) {
                                            settings.only.emplace_back(value);
                                            return true;
                                          }}}});
  if (!read(options, count, arguments, __FILE__, &names)) return 1;
  if (names.empty()) throw std::runtime_error("usage: follower-bench [options] orbit|wall|FOLDER…");
  const Lab lab;
  for (const std::string& name : names) {
    const auto source = open_rgbd(lab, name, settings);
    compare(lab, std::filesystem::path(name).filename().string(), *source, settings);
  }
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  return inverse::bench::run_main("follower-bench", inverse::bench::run, argc, argv);
}
