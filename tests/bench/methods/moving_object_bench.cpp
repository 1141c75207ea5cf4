// SPDX-License-Identifier: LGPL-2.1-or-later
// Cost of a small object moving over a static image with tiles skipped, and the distance of the
// layers from those of adaptive=false. The object crosses the image, then keeps moving in a corner,
// so that its former tiles have time to converge.
//
//   moving-object-bench [--frames N] [--cross N] [--every N] [--setting NAME=VALUE …] FILE…
//
// The files are scenes of ./dev bench (build-bench/tests/bench/scenes; import-scenes) or, named
// .dump, frames without truth (frames.hpp); the first frame of each is the static image. Both
// settings take turns on every frame; times are processor time, medians. Distances are of log
// shading in the solver's own scale.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/intrinsic/intrinsic_decomposition.hpp"
#include "tests/bench/support/changed_tiles.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/frames.hpp"
#include "tests/bench/support/scene.hpp"
#include "tests/bench/support/timing.hpp"

namespace inverse::bench {
namespace {

using Params = IntrinsicDecomposition::Params;
constexpr int kTile = int(TileList::kTile);

Image first_frame(const std::filesystem::path& path) {
  if (path.extension() != ".dump") return read_scene(path.string()).frames.front().input;
  const RgbaFrame frame = read_frames(path.string()).front();
  Image image(int(frame.extent.width), int(frame.extent.height), 3);
  for (size_t i = 0; i < frame.extent.pixels(); ++i)
    for (size_t c = 0; c < 3; ++c) image.data[3 * i + c] = frame.pixels[4 * i + c];
  return image;
}

/// A shaded ball with a radius of a twentieth of the width: it crosses the image for `cross`
/// frames, then moves in its lower right corner.
Image with_ball(Image picture, int number, int cross) {
  const double radius = picture.width / 20.0;
  double x0 = 0, y0 = 0;
  const double right = picture.width - 2.5 * radius, low = picture.height - 2.5 * radius;
  if (number < cross) {
    const double t = double(number) / cross;
    x0 = 1.5 * radius + (right - 1.5 * radius) * t;
    y0 = picture.height * (0.5 + 0.3 * std::sin(7 * t)) * (1 - t) + low * t;
  } else {
    x0 = right + radius * std::cos(0.3 * (number - cross)) - radius;
    y0 = low + radius * std::sin(0.3 * (number - cross));
  }
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const double u = (x - x0) / radius, v = (y - y0) / radius;
      if (u * u + v * v >= 1) continue;
      const double light =
          0.2 + 0.8 * std::max(0.0, -0.5 * u - 0.6 * v + 0.62 * std::sqrt(1 - u * u - v * v));
      const double paint[] = {0.7, 0.35, 0.2};
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = float(light * paint[c]);
    }
  return picture;
}

struct Distance {
  double rms = 0;    // over pixels
  double tile = 0;   // largest mean of a tile
  double pixel = 0;  // largest of all
};
Distance distance(const Image& a, double scale_a, const Image& b, double scale_b) {
  Distance all;
  const int columns = (a.width + kTile - 1) / kTile, rows = (a.height + kTile - 1) / kTile;
  std::vector<double> sums(size_t(columns) * size_t(rows)), counts(sums.size());
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const double d =
          std::log(double(a.at(x, y))) + scale_a - std::log(double(b.at(x, y))) - scale_b;
      all.rms += d * d;
      all.pixel = std::max(all.pixel, std::abs(d));
      sums[size_t(y / kTile * columns + x / kTile)] += d;
      counts[size_t(y / kTile * columns + x / kTile)] += 1;
    }
  for (size_t i = 0; i < sums.size(); ++i)
    all.tile = std::max(all.tile, std::abs(sums[i] / counts[i]));
  all.rms = std::sqrt(all.rms / (double(a.width) * a.height));
  return all;
}

struct Run {
  Params params;
  IntrinsicDecomposition method;
  Decomposition now, before;
  std::vector<double> cost, tiles;
  double step = 0;  // largest change of a static pixel's log shading per frame since the last read

  Run(DeviceSession& session, Extent extent, const Params& with)
      : params(with), method(session.device(), extent) {}
  void take(DeviceSession& session, const Image& frame, const std::vector<uint8_t>& changed) {
    Cost spent;
    before = std::move(now);
    now = session.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method.record(commands, input, params, {false, changed});
        },
        spent);
    cost.push_back(spent.processor);
    tiles.push_back(method.findings().tiles_active);
    if (before.shading.data.empty() || changed.empty()) return;
    const int columns = (frame.width + kTile - 1) / kTile;
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x)
        if (!changed[size_t(y / kTile * columns + x / kTile)])
          step = std::max(step, std::abs(std::log(double(now.shading.at(x, y)) /
                                                  double(before.shading.at(x, y)))));
  }
};

double mean(const std::vector<double>& values, size_t from) {
  double sum = 0;
  for (size_t i = from; i < values.size(); ++i) sum += values[i];
  return values.size() > from ? sum / double(values.size() - from) : 0;
}

void set(Params& params, const std::string& text) {
  const size_t at = text.find('=');
  const std::string name = text.substr(0, at);
  const float value = std::stof(text.substr(at + 1));
  if (name == "tile-tolerance")
    params.tolerances.tile = value;
  else if (name == "warm-cycles")
    params.warm_cycles = uint32_t(value);
  else if (name == "settled")
    params.tolerances.cycle = value;
  else
    throw std::runtime_error("no setting " + name);
}

void run(int argc, char** argv) {
  int frames = 160, cross = 48, every = 16;
  Params params, off;
  off.adaptive = false;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool more = i + 1 < argc;
    if (word == "--frames" && more)
      frames = std::stoi(argv[++i]);
    else if (word == "--cross" && more)
      cross = std::stoi(argv[++i]);
    else if (word == "--every" && more)
      every = std::max(1, std::stoi(argv[++i]));
    else if (word == "--setting" && more)
      set(params, argv[++i]);
    else
      files.push_back(word);
  }
  if (files.empty())
    throw std::runtime_error(
        "usage: moving-object-bench [--frames N] [--cross N] [--every N] [--setting NAME=VALUE …] "
        "FILE…");
  DeviceSession session("");
  for (const auto& file : files) {
    const Image still = first_frame(file);
    const Extent extent{uint32_t(still.width), uint32_t(still.height)};
    Run some(session, extent, params), all(session, extent, off);
    std::printf("%s, %dx%d\nframe   rms  tile pixel | scale | step (all) \n",
                std::filesystem::path(file).stem().c_str(), still.width, still.height);
    Image before;
    for (int k = 0; k < frames; ++k) {
      const Image frame = with_ball(still, k, cross);
      const auto changed = k > 0 ? changed_tiles(before, frame) : std::vector<uint8_t>();
      for (Run* run : {k % 2 ? &all : &some, k % 2 ? &some : &all})
        run->take(session, frame, run == &some ? changed : std::vector<uint8_t>());
      before = frame;
      if ((k + 1) % every) continue;
      const double a = double(some.method.findings().scale),
                   b = double(all.method.findings().scale);
      const Distance d = distance(some.now.shading, a, all.now.shading, b);
      std::printf("%5d  %.4f %.3f %.3f | %+.3f | %.3f\n", k + 1, d.rms, d.tile, d.pixel, a - b,
                  some.step);
      std::fflush(stdout);
      some.step = all.step = 0;
    }
    std::printf("processor ms %.1f / %.1f = %.3f, tiles %.1f of %u\n",
                median(std::vector(some.cost.begin() + 8, some.cost.end())),
                median(std::vector(all.cost.begin() + 8, all.cost.end())),
                mean(some.cost, 8) / mean(all.cost, 8), mean(some.tiles, 8),
                some.method.stats(some.method.recorded() - 1).tiles);
  }
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  inverse::bench::run(argc, argv);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "moving-object-bench: %s\n", error.what());
  return 1;
}
