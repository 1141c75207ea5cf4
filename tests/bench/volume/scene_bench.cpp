// SPDX-License-Identifier: LGPL-2.1-or-later
// What the memory of a scene brings to the decomposition of frames with depth.
//
//   scene-bench [--frames N] [--size WxH] [--rate FPS] [--noise N] [--voxel M] [--weight W]…
//               [--every K] [--max-width PIXELS]
//               orbit|wall|FOLDER…
//
// Sources are those of tracking-bench (rgbd_source.hpp); FOLDER has true reflectance (R) and
// shading (Sdir, Sind). Runs intrinsicdecomp at its defaults without memory and with each weight (1
// if none is given). Prints a table: LMSE (k = 20, mean of reflectance and shading) over all frames
// and of the last one; flicker of ln R along true motion, and without a common scale; drift of the
// scale over 30 frames; LMSE of the reflectance that the volume has where the last frame looks, and
// of a volume of colors in its place (flat light is then part of it); device time, ms, of the solve
// (median) and of all that the memory takes (mean, as not every frame is added).
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "kernels/intrinsic/intrinsic_levels.hpp"
#include "kernels/volume/memory/scene_memory.hpp"
#include "rgbd_source.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/scenes/datasets.hpp"
#include "tests/bench/support/timing.hpp"

namespace inverse::bench {
namespace {

struct Settings : RgbdSettings {
  double voxel = 0.01;
  int every = int(SceneMemory::Params{}.every), max_width = int(SceneMemory::Params{}.max_width);
  std::vector<double> weights;
};

/// A frame and its truth.
struct Taken {
  RgbdFrame frame;
  std::vector<uint16_t> depth;  // millimeters
  Image reflectance, shading;
};

Image image_of(const Pixels& pixels, Extent extent, int first, int channels) {
  Image image(int(extent.width), int(extent.height), channels);
  for (size_t i = 0; i < extent.pixels(); ++i)
    for (int c = 0; c < channels; ++c)
      image.data[i * size_t(channels) + size_t(c)] = pixels[4 * i + size_t(first + c)];
  return image;
}

std::vector<Taken> take(const Lab& lab, const std::string& name, RgbdSource& source) {
  std::vector<Taken> frames;
  for (int n = 0; n < source.frames(); ++n) {
    Taken taken{source.frame(lab, n), {}, {}, {}};
    for (const float z : lab.download(taken.frame.depth))
      taken.depth.push_back(uint16_t(std::lround(1000 * double(z))));
    if (std::filesystem::is_directory(name)) {
      const LabeledFrame truth = load_rendered(name, n, Regime::kNearConstantValue);
      taken.reflectance = truth.reflectance;
      taken.shading = truth.shading;
    } else {
      const Pixels layers = lab.download(taken.frame.layers);
      taken.reflectance = image_of(layers, source.extent(), 0, 3);
      taken.shading = image_of(layers, source.extent(), 3, 1);
    }
    frames.push_back(std::move(taken));
  }
  return frames;
}

/// Whether the true reflectance around a pixel is one, so that it does not matter where in between
/// pixels a point is.
bool even_at(const Image& reflectance, long x, long y) {
  constexpr int kReach = 2;
  constexpr double kStep = 0.02;
  for (int c = 0; c < 3; ++c) {
    double low = 1e9, high = 0;
    for (int dy = -kReach; dy <= kReach; ++dy)
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const int px = std::clamp(int(x) + dx, 0, reflectance.width - 1),
                  py = std::clamp(int(y) + dy, 0, reflectance.height - 1);
        low = std::min(low, double{reflectance.at(px, py, c)});
        high = std::max(high, double{reflectance.at(px, py, c)});
      }
    if (high - low > kStep) return false;
  }
  return true;
}

/// Where the points of every 8th pixel of some frames are in all frames, as far as they are seen on
/// surfaces of one color.
std::vector<Track> tracks_of(const std::vector<Taken>& frames, const Lens& lens, Extent extent) {
  constexpr double kSame = 0.01;  // meters
  std::vector<Track> tracks;
  std::vector<std::array<double, 12>> rows;
  for (const Taken& taken : frames) rows.push_back(rows_of(taken.frame.pose));
  const auto depth_at = [&](size_t n, long x, long y) {
    return double{frames[n].frame.true_depth[size_t(y) * extent.width + size_t(x)]};
  };
  for (size_t from = 0; from < frames.size(); from += std::max<size_t>(frames.size() / 3, 1))
    for (long y = 4; y < long(extent.height); y += 8)
      for (long x = 4; x < long(extent.width); x += 8) {
        const double z = depth_at(from, x, y);
        if (!(z > 0 && z < 10)) continue;
        const double p[] = {(double(x) - double{lens.cx}) / double{lens.fx} * z,
                            (double(y) - double{lens.cy}) / double{lens.fy} * z, z};
        double world[3];
        for (size_t r = 0; r < 3; ++r)
          world[r] = rows[from][4 * r] * p[0] + rows[from][4 * r + 1] * p[1] +
                     rows[from][4 * r + 2] * p[2] + rows[from][4 * r + 3];
        Track track;
        for (size_t n = 0; n < frames.size(); ++n) {
          double q[3] = {};
          for (size_t r = 0; r < 3; ++r)
            for (size_t c = 0; c < 3; ++c)
              q[c] += rows[n][4 * r + c] * (world[r] - rows[n][4 * r + 3]);
          const double u = double{lens.fx} * q[0] / q[2] + double{lens.cx},
                       v = double{lens.fy} * q[1] / q[2] + double{lens.cy};
          const bool inside =
              q[2] > 0 && u >= 1 && v >= 1 && u < extent.width - 2 && v < extent.height - 2;
          const bool seen = inside &&
                            std::abs(depth_at(n, std::lround(u), std::lround(v)) - q[2]) < kSame &&
                            even_at(frames[n].reflectance, std::lround(u), std::lround(v));
          track.push_back(seen ? std::array{u, v} : std::array{std::nan(""), std::nan("")});
        }
        tracks.push_back(std::move(track));
      }
  return tracks;
}

SceneMemory::Depth depth_of(const Taken& taken, const Lens& lens, Extent extent) {
  return {reinterpret_cast<const std::byte*>(taken.depth.data()),
          extent.width * sizeof(uint16_t),
          extent,
          0.001F,
          lens,
          taken.frame.pose};
}

/// LMSE of what is known of a frame's reflectance, where it is.
double known_error(const Lab& lab, const KnownReflectance& known, const Image& truth) {
  const Pixels pixels = lab.download(known.reflectance);
  Image estimate(truth.width, truth.height, 3), mask(truth.width, truth.height, 1);
  const auto nearest = [](size_t at, int of, uint32_t size) {
    return (2 * at + 1) * size / (2 * size_t(of));
  };
  for (size_t i = 0; i < mask.data.size(); ++i) {
    const size_t x = i % size_t(truth.width), y = i / size_t(truth.width),
                 at = nearest(y, truth.height, known.extent.height) * known.extent.width +
                      nearest(x, truth.width, known.extent.width);
    mask.data[i] = pixels[4 * at + 3] > 0 ? 1.0F : 0.0F;
    for (size_t c = 0; c < 3; ++c) estimate.data[3 * i + c] = std::exp(pixels[4 * at + c]);
  }
  return lmse(estimate, truth, mask);
}

/// One row. `weight` below 0: without memory.
void run_one(const Lab& lab, const std::string& name, const std::vector<Taken>& frames,
             const std::vector<Track>& tracks, const RgbdSource& source, const Settings& settings,
             double weight) {
  const Extent extent = source.extent();
  ScaledIntrinsic::Params params;
  const auto& levels = intrinsic_levels();
  levels.levels[levels.top(Quality::medium)].set(params);
  ScaledIntrinsic method(lab.device(), extent);
  SceneMemory::Params made;
  made.volume.voxel = float(settings.voxel);
  made.every = uint32_t(settings.every);
  made.max_width = uint32_t(settings.max_width);
  made.weight = float(std::max(weight, 0.0));
  std::optional<SceneMemory> memory, colors;
  if (weight >= 0)
    memory.emplace(lab.device(), extent, made), colors.emplace(lab.device(), extent, made);
  std::vector<Image> reflectance;
  std::vector<double> solve, scene;
  double errors = 0, last = 0, fused = 0, fused_colors = 0;
  gpu::Commands commands(lab.device());
  for (size_t n = 0; n < frames.size(); ++n) {
    const Taken& taken = frames[n];
    const auto input = std::make_shared<Plane>(Plane{extent, taken.frame.picture});
    commands.begin();
    std::optional<KnownReflectance> known;
    if (memory)
      known = memory->record_recall(commands, n, depth_of(taken, source.lens(), extent), *input);
    const Layers layers =
        method.record(commands, input, params,
                      {.reset = n == 0, .known = known && weight > 0 ? &*known : nullptr});
    if (memory) memory->record_remember(commands, *layers[Role::intrinsic]);
    commands.submit();
    commands.wait();
    double all = 0, of_scene = 0;
    for (const auto& stage : commands.stages()) {
      all += stage.milliseconds;
      const std::string& s = stage.name;
      if (s == "camera" || s == "view" || s == "fusion" || s == "target" || s == "recall")
        of_scene += stage.milliseconds;
    }
    solve.push_back(all - of_scene);
    scene.push_back(of_scene);
    const Pixels pixels = lab.download(layers[Role::intrinsic]->buffer);
    reflectance.push_back(image_of(pixels, extent, 0, 3));
    last = score_lmse(reflectance.back(), image_of(pixels, extent, 3, 1), taken.reflectance,
                      taken.shading, {});
    errors += last;
    if (known && n + 1 == frames.size()) fused = known_error(lab, *known, taken.reflectance);
    if (colors)
      lab.run([&](gpu::Commands& extra) {
        known = colors->record_recall(extra, n, depth_of(taken, source.lens(), extent), *input);
        colors->record_remember(extra, *input);
      });
    if (known && n + 1 == frames.size()) fused_colors = known_error(lab, *known, taken.reflectance);
  }
  printf("| %s | %s | %.4f | %.4f | %.4f | %.4f | %.4f | %.4f | %.4f | %.1f | %.1f |\n",
         std::filesystem::path(name).filename().c_str(),
         weight < 0 ? "none" : std::to_string(weight).substr(0, 6).c_str(),
         errors / double(frames.size()), last, flicker_along(reflectance, tracks, false),
         flicker_along(reflectance, tracks, true),
         common_drift(reflectance, tracks, std::min<size_t>(30, frames.size() / 2)), fused,
         fused_colors, median(solve),
         std::accumulate(scene.begin(), scene.end(), 0.0) / double(scene.size()));
  fflush(stdout);
}

int run(int count, char** arguments) {
  Settings settings;
  std::vector<std::string> names;
  const Options options =
      rgbd_options(settings, {{"--voxel", number(settings.voxel)},
                              {"--every", integer(settings.every)},
                              {"--max-width", integer(settings.max_width)},
                              {"--weight", {true, [&](const char* value) {
                                              settings.weights.push_back(std::stod(value));
                                              return true;
                                            }}}});
  if (!read(options, count, arguments, __FILE__, &names)) return 1;
  if (names.empty()) throw std::runtime_error("usage: scene-bench [options] orbit|wall|FOLDER…");
  if (settings.weights.empty()) settings.weights = {double{SceneMemory::Params{}.weight}};
  const Lab lab;
  printf(
      "| | weight | LMSE | last | flicker | without scale | drift | fused R | fused color | solve "
      "ms | memory ms |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : names) {
    const auto source = open_rgbd(lab, name, settings);
    const std::vector<Taken> frames = take(lab, name, *source);
    const std::vector<Track> tracks = tracks_of(frames, source->lens(), source->extent());
    run_one(lab, name, frames, tracks, *source, settings, -1);
    for (const double weight : settings.weights)
      run_one(lab, name, frames, tracks, *source, settings, weight);
  }
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int count, char** arguments) {
  try {
    return inverse::bench::run(count, arguments);
  } catch (const std::exception& error) {
    fprintf(stderr, "scene-bench: %s\n", error.what());
    return 1;
  }
}
