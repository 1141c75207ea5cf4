// SPDX-License-Identifier: LGPL-2.1-or-later
// What intrinsicdecomp skips depending on the scene: saved time and change of the result, for
// chroma bins and the temporal anchor one by one (terms), and for everything by skip-error (error).
//
//   skip-bench terms|error [--frames N] FOLDER…
//
// The folders hold scenes of ./dev bench (build-bench/tests/bench/scenes; import-scenes). Settings
// take turns on every frame; times are processor time, medians of ratios.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/scene.hpp"
#include "tests/bench/support/timing.hpp"

namespace inverse::bench {
namespace {

using Params = ScaledIntrinsic::Params;

/// RMS of ln(a / b), one factor removed, over pixels weighted as in LayerDistance.
double distance(const Image& frame, const Image& a, const Image& b) {
  double weights = 0, sum = 0, squares = 0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    const double light = (double(frame.data[3 * i]) + double(frame.data[3 * i + 1]) +
                          double(frame.data[3 * i + 2])) /
                         3;
    const double w = light / (light + 0.02);
    const double d =
        std::log(std::max(double(a.data[i]), 1e-20)) - std::log(std::max(double(b.data[i]), 1e-20));
    weights += w, sum += w * d, squares += w * d * d;
  }
  if (!(weights > 0)) return 0;
  const double mean = sum / weights;
  return std::sqrt(std::max(squares / weights - mean * mean, 0.0));
}

/// One setting on one scene.
struct Run {
  ScaledIntrinsic method;
  Params params;
  Decomposition now;
  std::vector<double> cost, lmse;

  Run(DeviceSession& session, Extent extent, const Params& with)
      : method(session.device(), extent), params(with) {}
  void step(DeviceSession& session, const TruthFrame& frame, bool reset, bool repeated = false) {
    Cost spent;
    now = session.run(
        frame.input,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method.record(commands, input, params, {.reset = reset, .repeated = repeated});
        },
        spent);
    cost.push_back(spent.processor);
  }
  void judge(const TruthFrame& frame) {
    if (!frame.reflectance.empty())
      lmse.push_back(
          score(now.reflectance, now.shading, frame.reflectance, frame.shading, frame.mask).lmse20);
  }
  ScaledIntrinsic::Findings found() const { return method.findings(method.recorded() - 1); }
};

/// Median of b's cost relative to a's, frame by frame, without the first two.
double ratio(const Run& a, const Run& b) {
  std::vector<double> ratios;
  for (size_t i = 2; i < a.cost.size(); ++i) ratios.push_back(b.cost[i] / a.cost[i]);
  return median(ratios);
}

/// Images without comparable colors, and without any.
std::vector<Scene> poor_scenes() {
  std::vector<Scene> scenes;
  const auto add = [&](const char* name, auto value) {
    Scene scene{"poor", name, "", true, {}};
    TruthFrame frame;
    frame.input = Image(640, 480, 3);
    for (int y = 0; y < 480; ++y)
      for (int x = 0; x < 640; ++x)
        for (int c = 0; c < 3; ++c) frame.input.at(x, y, c) = value(x, y);
    scene.frames.assign(2, frame);
    scenes.push_back(scene);
  };
  add("black", [](int, int) { return 0.0F; });
  add("one gray", [](int, int) { return 0.4F; });
  add("gray ramp", [](int x, int y) { return 0.1F + 0.001F * float(x) + 0.0002F * float(y); });
  add("slide", [](int x, int y) {
    return y % 60 > 20 && y % 60 < 44 && (x / 7 * 37 + y / 60 * 11) % 5 < 2 ? 0.02F : 0.9F;
  });
  return scenes;
}

void name(const Scene& scene) {
  const Image& first = scene.frames.front().input;
  std::printf("| %s %s, %dx%d | ", scene.set.c_str(), scene.name.c_str(), first.width,
              first.height);
}

/// A frame of a scene that plays forwards and backwards; a still is repeated.
const TruthFrame& frame_at(const Scene& scene, size_t k) {
  if (!scene.video || scene.frames.size() == 1) return scene.frames.front();
  const size_t period = 2 * scene.frames.size() - 2, at = k % period;
  return scene.frames[at < scene.frames.size() ? at : period - at];
}

void terms(DeviceSession& session, const Scene& scene, size_t frames) {
  const Extent extent{uint32_t(scene.frames[0].input.width),
                      uint32_t(scene.frames[0].input.height)};
  Params all, bins, pixels, chosen;
  chosen.tolerances.half = 0;
  all.tolerances.chroma = all.tolerances.gate = all.tolerances.half = 0;
  bins = pixels = all;
  bins.prior.chroma_weight = 0;  // as if skipped
  pixels.tolerances.gate = 1;
  Run runs[] = {{session, extent, all},
                {session, extent, bins},
                {session, extent, pixels},
                {session, extent, chosen}};
  double binding = 0, gate = 0;
  std::vector<double> change[4];
  for (size_t k = 0; k < frames; ++k) {
    const TruthFrame& frame = frame_at(scene, k);
    for (Run& run : runs) run.step(session, frame, k == 0);
    binding = std::max(binding, double(runs[0].found().binding));
    gate = std::max(gate, double(runs[0].found().gate));
    if (k < 2) continue;
    for (size_t i = 1; i < 4; ++i)
      change[i].push_back(distance(frame.input, runs[0].now.shading, runs[i].now.shading));
    if (k % 3 == 2)
      for (Run& run : runs) run.judge(frame);
  }
  const auto& last = runs[3].method.stats(runs[3].method.recorded() - 1).plan.skipped;
  name(scene);
  std::printf("%.3f | %.3f | %.2f | %.3f | %.4f | %.2f | %.4f | %.2f | ", binding, mean(change[1]),
              ratio(runs[0], runs[1]), gate, mean(change[2]), ratio(runs[0], runs[2]),
              mean(change[3]), ratio(runs[0], runs[3]));
  std::printf("%.4f, %.4f, %.4f, %.4f | ", mean(runs[0].lmse), mean(runs[1].lmse),
              mean(runs[2].lmse), mean(runs[3].lmse));
  for (const auto& reason : last) std::printf("%s; ", reason.c_str());
  std::printf("|\n");
}

/// For skip-error at 0, a quarter of the default, the default and twice that: distance of shading
/// from that with all work done, mean and maximum over the frames, and relative time.
void error(DeviceSession& session, const Scene& scene, size_t frames) {
  const Extent extent{uint32_t(scene.frames[0].input.width),
                      uint32_t(scene.frames[0].input.height)};
  Params off;
  off.adaptive = false;
  Run all{session, extent, off};
  std::vector<std::unique_ptr<Run>> some;
  for (const float factor : {0.0F, 0.25F, 1.0F, 2.0F}) {
    Params params;
    params.adaptive = factor > 0;
    params.tolerances.scale_to(factor * Tolerances::kSkipError);
    some.push_back(std::make_unique<Run>(session, extent, params));
  }
  std::vector<std::vector<double>> apart(some.size());
  TruthFrame before;
  for (size_t k = 0; k < frames; ++k) {
    TruthFrame frame = frame_at(scene, k);
    frame.input = through_8_bits(frame.input);
    const bool repeated = k > 0 && before.input.data == frame.input.data;
    all.step(session, frame, k == 0);
    for (size_t i = 0; i < some.size(); ++i) {
      some[i]->step(session, frame, k == 0, repeated);
      apart[i].push_back(distance(frame.input, all.now.shading, some[i]->now.shading));
    }
    before = frame;
  }
  name(scene);
  for (size_t i = 0; i < some.size(); ++i)
    std::printf("%.4f, %.4f, %.2f | ", mean(apart[i]),
                *std::max_element(apart[i].begin(), apart[i].end()), ratio(all, *some[i]));
  std::printf("\n");
}

void run(int argc, char** argv) {
  std::string what = argc > 1 ? argv[1] : "";
  const auto measure = what == "terms" ? terms : what == "error" ? error : nullptr;
  std::vector<std::filesystem::path> files;
  size_t frames = 24;
  for (int i = 2; i < argc; ++i) {
    if (std::string(argv[i]) == "--frames" && i + 1 < argc)
      frames = size_t(std::max(4, std::stoi(argv[++i])));
    else
      for (const auto& entry : std::filesystem::directory_iterator(argv[i]))
        files.push_back(entry.path());
  }
  if (!measure || files.empty())
    throw std::runtime_error("usage: skip-bench terms|error [--frames N] FOLDER…");
  std::sort(files.begin(), files.end());
  DeviceSession session("");
  if (measure == terms)
    for (const Scene& scene : poor_scenes()) measure(session, scene, frames);
  for (const auto& file : files) {
    measure(session, read_scene(file), frames);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  inverse::bench::run(argc, argv);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "skip-bench: %s\n", error.what());
  return 1;
}
