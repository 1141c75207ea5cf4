// SPDX-License-Identifier: LGPL-2.1-or-later
// import-scenes FROM TO [--frames N] [--videos]: turns image folders with ground truth into the
// benchmark's flat dumps. Prints a line for each set.
//
// Any folder below FROM (three levels) that holds original.png, reflectance.png, shading.png and
// mask.png is a still in the form of the MIT set; one that holds I8, R, Sdir and Sind a rendered
// sequence, of which N frames (default 1, 0: all) spread evenly become stills, and with --videos
// all become a video. Where nothing but the light of a sequence changes, --videos adds two more:
// "slow light" with five steps for every one, and "noise", its first frame eight times under a
// camera's noise.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <random>
#include <string>

#include "datasets.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/support/scene.hpp"

namespace inverse::bench {
namespace {

namespace fs = std::filesystem;

std::string blanks(std::string text) {
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

/// Numbers of the frames to take of a sequence of `count`.
std::vector<int> spread(int count, int take) {
  take = take <= 0 ? count : std::min(take, count);
  std::vector<int> numbers;
  for (int k = 0; k < take; ++k)
    numbers.push_back(take == 1 ? count / 2 : k * (count - 1) / (take - 1));
  return numbers;
}

/// Whether the true reflectance of every pixel is constant.
bool stands_still(const Scene& video) {
  std::vector<Image> truth;
  for (const TruthFrame& frame : video.frames) truth.push_back(frame.reflectance);
  const Image still = static_pixels(truth);
  return std::all_of(still.data.begin(), still.data.end(), [](float v) { return v == 1; });
}

/// The same with steps of light divided by `parts`: light adds up.
Scene slow_light(const Scene& video, int parts) {
  Scene slow{video.set, "slow light", "everything changes", true, {}};
  for (std::size_t k = 0; k + 1 < video.frames.size(); ++k)
    for (int j = 0; j < parts; ++j) {
      slow.frames.push_back(video.frames[k]);
      const float share = float(j) / float(parts);
      const auto mix = [share](Image& to, const Image& next) {
        for (std::size_t i = 0; i < to.data.size(); ++i)
          to.data[i] += share * (next.data[i] - to.data[i]);
      };
      mix(slow.frames.back().input, video.frames[k + 1].input);
      mix(slow.frames.back().shading, video.frames[k + 1].shading);
      mix(slow.frames.back().direct, video.frames[k + 1].direct);
      mix(slow.frames.back().indirect, video.frames[k + 1].indirect);
    }
  return slow;
}

/// The first frame, repeated with noise.
Scene noise(const Scene& video, std::size_t count) {
  std::mt19937 random(1);
  Scene noisy{video.set, "noise", "sensor noise only", true, {count, video.frames.front()}};
  for (TruthFrame& frame : noisy.frames) frame.input = with_noise(frame.input, random);
  return noisy;
}

void run(const std::string& from, const std::string& to, int frames, bool videos) {
  std::vector<fs::path> folders;
  for (auto it = fs::recursive_directory_iterator(from); it != fs::recursive_directory_iterator();
       ++it) {
    if (it.depth() > 2) it.disable_recursion_pending();
    if (it->is_directory()) folders.push_back(it->path());
  }
  std::sort(folders.begin(), folders.end());
  std::map<std::string, int> counts;
  for (const fs::path& folder : folders) {
    const std::string name = blanks(folder.filename().string());
    if (fs::exists(folder / "original.png") && fs::exists(folder / "reflectance.png")) {
      const std::string set = blanks(folder.parent_path().filename().string());
      write_scene(to, {set, name, regime_title(Regime::kMit), false, {load_mit(folder.string())}});
      ++counts[set];
    } else if (fs::exists(folder / "I8" / "000.png") && fs::exists(folder / "R") &&
               fs::exists(folder / "Sdir")) {
      const Regime regime = regime_of(folder.filename().string());
      const int count = count_frames(folder.string());
      Scene stills{folder.filename().string(), "stills", regime_title(regime), false, {}};
      for (const int k : spread(count, frames))
        stills.frames.push_back(load_rendered(folder.string(), k, regime));
      write_scene(to, stills);
      if (videos) {
        Scene video{folder.filename().string(), "video", regime_title(regime), true, {}};
        for (int k = 0; k < count; ++k)
          video.frames.push_back(load_rendered(folder.string(), k, regime));
        write_scene(to, video);
        if (count > 1 && stands_still(video)) {
          write_scene(to, slow_light(video, 5));
          write_scene(to, noise(video, 8));
        }
      }
      ++counts[stills.set];
    }
  }
  for (const auto& [set, count] : counts) std::printf("%s: %d\n", set.c_str(), count);
  if (counts.empty()) throw std::runtime_error("no ground truth in " + from);
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  std::string from, to;
  int frames = 1;
  bool videos = false;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--frames" && i + 1 < argc)
      frames = std::stoi(argv[++i]);
    else if (argument == "--videos")
      videos = true;
    else
      (from.empty() ? from : to) = argument;
  }
  if (to.empty()) throw std::runtime_error("usage: import-scenes FROM TO [--frames N] [--videos]");
  inverse::bench::run(from, to, frames, videos);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "import-scenes: %s\n", error.what());
  return 1;
}
