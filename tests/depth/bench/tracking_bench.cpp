// SPDX-License-Identifier: LGPL-2.1-or-later
// Tracking and fusion of a depth camera: error of its path, and time by part.
//
//   tracking-bench [--frames N] [--size WxH] [--rate FPS] [--gap N] [--noise N] [--voxel M]
//   [--photometric M]
//                  orbit|wall|FOLDER…
//
// orbit and wall are paths in the virtual room (kernels/depth/virtual_room), whose depth has the
// noise and holes of a structured-light sensor, times N. A FOLDER is a recording as desk_rgbd in
// the given data: meta.json, I8/NNN.png and Zkinect/NNN.png; with --noise 0 Z/NNN.png. Prints a
// table: root of the mean square distance to the true place (the first pose is given), the largest
// one, that of the last frame, frames in which the camera was lost, and medians of device time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "kernels/depth/tracking/tracker.hpp"
#include "rgbd_source.hpp"
#include "tests/bench/support/timing.hpp"
#include "tests/lab.hpp"

namespace inverse::bench {
namespace {

struct Settings : RgbdSettings {
  double voxel = 0.01;
  double photometric = double{Tracker::Params{}.photometric[0]};
};

void follow(const Lab& lab, const std::string& name, RgbdSource& source, const Settings& settings) {
  const Extent extent = source.extent();
  const Lens lens = source.lens();
  Volume volume(lab.device(), {.voxel = float(settings.voxel)});
  Tracker tracker(lab.device(), extent);
  Volume::View view(lab.device(), extent);
  Tracker::Params params;
  const auto photometric = float(settings.photometric);
  params.photometric = {photometric, photometric, 0};
  double squares = 0, most = 0, last = 0;
  int lost = 0;
  std::map<std::string, std::vector<double>> times;
  gpu::Commands commands(lab.device());
  for (int n = 0; n < source.frames(); ++n) {
    const RgbdFrame frame = source.frame(lab, n);
    const auto truth = pose_on(lab, frame.pose);
    commands.begin();
    tracker.record_frame(commands, lens, frame.depth, frame.picture);
    if (n == 0)
      tracker.record_pose(commands, truth);
    else
      tracker.record_align(commands, params);
    commands.stage("tracking");
    volume.record_integrate(
        commands, {lens, extent, tracker.pose(), frame.depth, tracker.surface()}, frame.layers, {});
    commands.stage("fusion");
    volume.record_march(commands, lens, tracker.pose(), view);
    tracker.record_target(commands, view, frame.layers);
    commands.stage("rendering");
    commands.submit();
    commands.wait();
    if (n >= 3)  // kernels are built by then
      for (const auto& stage : commands.stages()) times[stage.name].push_back(stage.milliseconds);
    const Pixels pose = lab.download(tracker.pose());
    double square = 0;
    for (size_t c = 0; c < 3; ++c)
      square += std::pow(double{pose[4 + c]} - double{frame.pose.place[c]}, 2);
    squares += square;
    last = std::sqrt(square);
    most = std::max(most, last);
    lost += n > 0 && lab.download(tracker.found())[0] != 1;
  }
  const Pixels state = lab.download(volume.state());
  uint32_t left = 0;
  memcpy(&left, &state[shaders::depth_list::kFree], sizeof left);
  printf("| %s | %d | %.1f | %.1f | %.1f | %d | %.1f | %.1f | %.1f | %u |\n", name.c_str(),
         source.frames(), 1000 * std::sqrt(squares / source.frames()), 1000 * most, 1000 * last,
         lost, median(times["tracking"]), median(times["fusion"]), median(times["rendering"]),
         volume.params().blocks - left);
  fflush(stdout);
}

int run(int count, char** arguments) {
  Settings settings;
  std::vector<std::string> names;
  const Options options = rgbd_options(settings, {{"--voxel", number(settings.voxel)},
                                                  {"--photometric", number(settings.photometric)}});
  if (!read(options, count, arguments, __FILE__, &names)) return 1;
  if (names.empty()) throw std::runtime_error("usage: tracking-bench [options] orbit|wall|FOLDER");
  const Lab lab;
  printf("| | frames | rms mm | max | last | lost | tracking ms | fusion | rendering | blocks |\n");
  printf("|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : names) {
    const auto source = open_rgbd(lab, name, settings);
    follow(lab, std::filesystem::path(name).filename().string(), *source, settings);
  }
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  return inverse::bench::run_main("tracking-bench", inverse::bench::run, argc, argv);
}
