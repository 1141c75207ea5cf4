// SPDX-License-Identifier: LGPL-2.1-or-later
// How a lost camera is found again in a remembered scene.
//
//   recovery-bench [--frames N] [--size WxH] [--rate FPS] [--noise N] [--seed N] WALKED FROM…
//
// WALKED and FROM are paths of rgbd_source.hpp. The scene is remembered along WALKED; then the
// camera is looked for, without a pose, at every tenth frame of each path FROM, which it sees for
// up to kFrames frames. Prints for each FROM: places; the share where it was found, less than 5 cm
// from the truth; the median and largest number of frames that took; and places where it was
// declared found elsewhere.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "rgbd_source.hpp"

namespace inverse::bench {
namespace {

constexpr int kFrames = 60, kEvery = 10;
constexpr double kRight = 0.05;  // meters

class Walk {
 public:
  Walk(const Lab& lab, RgbdSource& along)
      : lab_(lab),
        memory_(lab.device(), along.extent(), {}),
        commands_(lab.device()),
        layers_{along.extent(), nullptr} {
    for (int n = 0; n < along.frames(); ++n) {
      const RgbdFrame frame = along.frame(lab, n);
      show(along, frame, n == 0 ? std::optional(frame.pose) : std::nullopt);
    }
    memory_.set_update(false);
  }

  /// Frames until the camera is found, from 1 on; negative if that is elsewhere; 0: it is not.
  int look(RgbdSource& from, const RgbdFrame& frame) {
    memory_.look_for_camera();
    for (int n = 1; n <= kFrames; ++n) {
      show(from, frame, {});
      if (!memory_.findings(number_ - 1)->found) continue;
      const auto view = memory_.view(number_ - 1);
      double square = 0;
      for (size_t c = 0; view && c < 3; ++c)
        square += std::pow(double{view->pose.place[c]} - double{frame.pose.place[c]}, 2);
      return view && std::sqrt(square) < kRight ? n : -n;
    }
    return 0;
  }

 private:
  void show(RgbdSource& source, const RgbdFrame& frame, const std::optional<Pose>& pose) {
    const std::vector<uint16_t> steps = millimeters_of(lab_, frame);
    commands_.begin();
    const Plane picture{source.extent(), frame.picture};
    memory_.record_recall(commands_, number_, depth_of(steps, source, pose), picture);
    layers_.buffer = frame.layers;
    memory_.record_remember(commands_, layers_);
    commands_.submit();
    commands_.wait();
    ++number_;
  }

  const Lab& lab_;
  SceneMemory memory_;
  gpu::Commands commands_;
  Plane layers_;
  uint64_t number_ = 0;
};

int run(int count, char** arguments) {
  RgbdSettings settings;
  settings.rate = 10;
  std::vector<std::string> names;
  const Options options = rgbd_options(settings, {});
  if (!read(options, count, arguments, __FILE__, &names)) return 1;
  if (names.size() < 2) throw std::runtime_error("usage: recovery-bench [options] WALKED FROM…");
  const Lab lab;
  Walk walk(lab, *open_rgbd(lab, names[0], settings));
  settings.rate *= 0.97;  // other frames than those that are remembered
  printf(
      "| from | places | found | frames, median | most | elsewhere |\n|---|---|---|---|---|---|\n");
  for (size_t i = 1; i < names.size(); ++i) {
    const auto source = open_rgbd(lab, names[i], settings);
    std::vector<int> frames;
    int places = 0, elsewhere = 0;
    for (int n = kEvery / 2; n < source->frames(); n += kEvery, ++places) {
      const int took = walk.look(*source, source->frame(lab, n));
      if (took > 0) frames.push_back(took);
      elsewhere += took < 0;
    }
    std::ranges::sort(frames);
    printf("| %s | %d | %.2f | %d | %d | %d |\n", names[i].c_str(), places,
           double(frames.size()) / std::max(places, 1),
           frames.empty() ? 0 : frames[frames.size() / 2], frames.empty() ? 0 : frames.back(),
           elsewhere);
    fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  return inverse::bench::run_main("recovery-bench", inverse::bench::run, argc, argv);
}
