// SPDX-License-Identifier: LGPL-2.1-or-later
// What the memory of a scene brings to the decomposition of frames with depth.
//
//   scene-bench [--frames N] [--size WxH] [--rate FPS] [--noise N] [--seed N] [--voxel M]
//               [--weight W]… [--depth-weight W] [--every K] [--max-width PIXELS] [--method NAME]…
//               [--pictures FOLDER] orbit|wall|FOLDER…
//
// Sources are those of tracking-bench (rgbd_source.hpp); FOLDER has true reflectance (R) and
// shading (Sdir, Sind). Methods are intrinsicdecomp (if none is given), globalintrinsic, chapter3
// and chapter4, the formulations of intrinsicdecompthesis. Runs each at its defaults, without
// memory and with each weight (that of its element if none is given). Prints a table: LMSE (k = 20,
// mean of reflectance and shading) over all frames and of the last one; flicker of ln R along true
// motion, and without a common scale; variation of the mean R of patches, from frame to frame and
// from the patch's mean over time; drift of the scale over 30 frames; LMSE of the reflectance that
// the volume has, seen from the places of the first, middle and last frame, and of a volume of
// colors in its place (light is then part of it); device time, ms, of the solve (median) and of all
// that the memory takes (mean, as not every frame is added).
// --pictures writes both volumes from these three places, above the truth (model_pictures.hpp).
//
// Patches are five of the 8 x 6 rectangles of the middle frame: those whose points are seen in most
// frames. They are followed by the true geometry.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "kernels/depth/memory/scene_memory.hpp"
#include "kernels/global/global_levels.hpp"
#include "kernels/intrinsic/intrinsic_levels.hpp"
#include "kernels/thesis/chapter3/thesis_decomposition.hpp"
#include "model_pictures.hpp"
#include "rgbd_source.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/scenes/datasets.hpp"
#include "tests/bench/support/timing.hpp"

namespace inverse::bench {
namespace {

const std::string kMethods[] = {"intrinsicdecomp", "globalintrinsic", "chapter3", "chapter4"};

struct Settings : RgbdSettings {
  double voxel = 0.01;
  int every = int(SceneMemory::Params{}.every), max_width = int(SceneMemory::Params{}.max_width);
  std::vector<double> weights;
  double depth_weight = double{EdgePrior::Params{}.depth_weight};
  std::vector<std::string> methods;
  std::string pictures;
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
    taken.depth = millimeters_of(lab, taken.frame);
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

/// Follows points by the true geometry.
class Follower {
 public:
  Follower(const std::vector<Taken>& frames, const Lens& lens, Extent extent)
      : frames_(frames), lens_(lens), extent_(extent) {
    for (const Taken& taken : frames) rows_.push_back(rows_of(taken.frame.pose));
  }

  /// Where the points of every `step`-th pixel of a part of a frame are in all frames, as far as
  /// they are seen on surfaces of one color.
  void add_tracks(std::vector<Track>& tracks, size_t from, long left, long top, long right,
                  long bottom, long step) const {
    for (long y = top; y < bottom; y += step)
      for (long x = left; x < right; x += step) {
        const double z = depth_at(from, x, y);
        if (!(z > 0 && z < 10)) continue;
        const double p[] = {(double(x) - double{lens_.cx}) / double{lens_.fx} * z,
                            (double(y) - double{lens_.cy}) / double{lens_.fy} * z, z};
        std::array<double, 3> world;
        for (size_t r = 0; r < 3; ++r)
          world[r] = rows_[from][4 * r] * p[0] + rows_[from][4 * r + 1] * p[1] +
                     rows_[from][4 * r + 2] * p[2] + rows_[from][4 * r + 3];
        Track track;
        for (size_t n = 0; n < frames_.size(); ++n) track.push_back(seen_at(world, n));
        tracks.push_back(std::move(track));
      }
  }

 private:
  double depth_at(size_t n, long x, long y) const {
    return double{frames_[n].frame.true_depth[size_t(y) * extent_.width + size_t(x)]};
  }
  std::array<double, 2> seen_at(const std::array<double, 3>& world, size_t n) const {
    constexpr double kSame = 0.01;  // meters
    double q[3] = {};
    for (size_t r = 0; r < 3; ++r)
      for (size_t c = 0; c < 3; ++c) q[c] += rows_[n][4 * r + c] * (world[r] - rows_[n][4 * r + 3]);
    const double u = double{lens_.fx} * q[0] / q[2] + double{lens_.cx},
                 v = double{lens_.fy} * q[1] / q[2] + double{lens_.cy};
    const bool inside =
        q[2] > 0 && u >= 1 && v >= 1 && u < extent_.width - 2 && v < extent_.height - 2;
    const bool seen = inside &&
                      std::abs(depth_at(n, std::lround(u), std::lround(v)) - q[2]) < kSame &&
                      even_at(frames_[n].reflectance, std::lround(u), std::lround(v));
    return seen ? std::array{u, v} : std::array{std::nan(""), std::nan("")};
  }

  const std::vector<Taken>& frames_;
  Lens lens_;
  Extent extent_;
  std::vector<std::array<double, 12>> rows_;
};

/// What is followed of a source.
struct Followed {
  std::vector<Track> points;                ///< of every 8th pixel of some frames
  std::vector<std::vector<Track>> patches;  ///< of every second one of five rectangles
};

Followed follow(const std::vector<Taken>& frames, const Lens& lens, Extent extent) {
  constexpr size_t kPatches = 5;
  constexpr long kAcross = 8, kDown = 6;
  const Follower follower(frames, lens, extent);
  const long width = extent.width, height = extent.height;
  Followed followed;
  for (size_t from = 0; from < frames.size(); from += std::max<size_t>(frames.size() / 3, 1))
    follower.add_tracks(followed.points, from, 4, 4, width, height, 8);
  const auto seen = [](const std::vector<Track>& patch) {
    long count = 0;
    for (const Track& track : patch)
      count += std::count_if(track.begin(), track.end(),
                             [](const auto& at) { return !std::isnan(at[0]); });
    return count;
  };
  for (long k = 0; k < kAcross * kDown; ++k) {
    const long x = k % kAcross, y = k / kAcross;
    follower.add_tracks(followed.patches.emplace_back(), frames.size() / 2, x * width / kAcross,
                        y * height / kDown, (x + 1) * width / kAcross, (y + 1) * height / kDown, 2);
  }
  std::ranges::stable_sort(followed.patches, std::ranges::greater{}, seen);
  followed.patches.resize(kPatches);
  return followed;
}

/// A decomposer: records a frame's work, and returns its layers.
using Solver = std::function<PlanePtr(gpu::Commands&, size_t frame, const PlanePtr& input,
                                      const KnownReflectance* known)>;

Solver solver_of(const Lab& lab, const std::string& method, Extent extent, double depth_weight) {
  const auto live = [&]<typename Method>(std::shared_ptr<Method> made, const auto& levels) {
    typename Method::Params params;
    levels.levels[levels.top(Quality::medium)].set(params);
    params.prior.depth_weight = float(depth_weight);
    return [=](gpu::Commands& commands, size_t frame, const PlanePtr& input,
               const KnownReflectance* known) {
      return made->record(commands, input, params,
                          {.reset = frame == 0, .known = known})[Role::intrinsic];
    };
  };
  if (method == "intrinsicdecomp")
    return live(std::make_shared<ScaledIntrinsic>(lab.device(), extent), intrinsic_levels());
  if (method == "globalintrinsic")
    return live(std::make_shared<GlobalIntrinsic>(lab.device(), extent), global_levels());
  ThesisParams params;
  if (method == "chapter4") set_chapter4(params);
  const auto made = std::make_shared<ThesisDecomposition>(lab.device(), extent);
  made->set_params(params);
  return
      [=](gpu::Commands& commands, size_t, const PlanePtr& input, const KnownReflectance* known) {
        Layers layers;
        made->record(commands, *input, layers, known);
        commands.keep(input);
        return layers[Role::intrinsic];
      };
}

/// One row. `weight` below 0: without memory.
void run_one(const Lab& lab, const std::string& name, const std::string& method,
             const std::vector<Taken>& frames, const Followed& followed, const RgbdSource& source,
             const Settings& settings, double weight) {
  const Extent extent = source.extent();
  const Solver solver = solver_of(lab, method, extent, settings.depth_weight);
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
  double errors = 0, last = 0;
  gpu::Commands commands(lab.device());
  for (size_t n = 0; n < frames.size(); ++n) {
    const Taken& taken = frames[n];
    const auto input = std::make_shared<Plane>(Plane{extent, taken.frame.picture});
    commands.begin();
    std::optional<KnownReflectance> known;
    if (memory)
      known = memory->record_recall(commands, n, depth_of(taken.depth, source, taken.frame.pose),
                                    *input);
    const PlanePtr layers = solver(commands, n, input, known && weight > 0 ? &*known : nullptr);
    if (memory) memory->record_remember(commands, *layers);
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
    const Pixels pixels = lab.download(layers->buffer);
    reflectance.push_back(image_of(pixels, extent, 0, 3));
    last = score_lmse(reflectance.back(), image_of(pixels, extent, 3, 1), taken.reflectance,
                      taken.shading, {});
    errors += last;
    if (colors)
      lab.run([&](gpu::Commands& extra) {
        colors->record_recall(extra, n, depth_of(taken.depth, source, taken.frame.pose), *input);
        colors->record_remember(extra, *input);
      });
  }
  ModelScore fused, fused_colors;
  if (memory) {
    std::vector<Side> sides;
    for (const size_t n : {size_t{0}, frames.size() / 2, frames.size() - 1})
      sides.push_back({frames[n].frame.pose, frames[n].reflectance});
    ModelPictures pictures(lab, source.lens(), sides);
    fused = pictures.add(memory->data().volume);
    fused_colors = pictures.add(colors->data().volume);
    if (!settings.pictures.empty())
      pictures.write(settings.pictures + "/" + std::filesystem::path(name).filename().string() +
                     "-" + method + ".png");
  }
  PatchVariation patches;
  for (const std::vector<Track>& patch : followed.patches) {
    const PatchVariation found = patch_variation(reflectance, patch);
    patches.step += found.step / double(followed.patches.size());
    patches.spread += found.spread / double(followed.patches.size());
  }
  printf(
      "| %s | %s | %s | %.4f | %.4f | %.4f | %.4f | %.4f | %.4f | %.4f | %.4f | %.4f | %.1f | %.1f "
      "|\n",
      std::filesystem::path(name).filename().c_str(), method.c_str(),
      weight < 0 ? "none" : std::to_string(weight).substr(0, 6).c_str(),
      errors / double(frames.size()), last, flicker_along(reflectance, followed.points, false),
      flicker_along(reflectance, followed.points, true), patches.step, patches.spread,
      common_drift(reflectance, followed.points, std::min<size_t>(30, frames.size() / 2)),
      fused.reflectance, fused_colors.reflectance, median(solve),
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
                              {"--pictures", text(settings.pictures)},
                              {"--method",
                               {true,
                                [&](const char* value) {
                                  settings.methods.emplace_back(value);
                                  return std::ranges::count(kMethods, settings.methods.back()) > 0;
                                }}},
                              {"--depth-weight", number(settings.depth_weight)},
                              {"--weight", {true, [&](const char* value) {
                                              settings.weights.push_back(std::stod(value));
                                              return true;
                                            }}}});
  if (!read(options, count, arguments, __FILE__, &names)) return 1;
  if (names.empty()) throw std::runtime_error("usage: scene-bench [options] orbit|wall|FOLDER…");
  if (settings.methods.empty()) settings.methods = {"intrinsicdecomp"};
  const Lab lab;
  printf(
      "| | method | weight | LMSE | last | flicker | without scale | patches, step | spread | "
      "drift "
      "| fused R | fused color | solve ms | memory ms |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : names) {
    const auto source = open_rgbd(lab, name, settings);
    const std::vector<Taken> frames = take(lab, name, *source);
    const Followed followed = follow(frames, source->lens(), source->extent());
    for (const std::string& method : settings.methods) {
      std::vector<double> weights = settings.weights;
      if (weights.empty()) weights = {method.starts_with("chapter") ? 10.0 : 1.0};
      weights.insert(weights.begin(), -1);
      for (const double weight : weights)
        run_one(lab, name, method, frames, followed, *source, settings, weight);
    }
  }
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) {
  return inverse::bench::run_main("scene-bench", inverse::bench::run, argc, argv);
}
