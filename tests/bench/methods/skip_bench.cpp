// SPDX-License-Identifier: LGPL-2.1-or-later
// What intrinsicdecomp skips depending on the scene, one by one: chroma bins, the temporal anchor,
// half of the resolution. Reports saved time, change of the result, and what was predicted; also
// the visible change when the resolution switches.
//
//   skip-bench terms|half|crossing|cheap|adaptive|error [--frames N] FOLDER…
//
// The folders hold scenes of ./dev bench (build-bench/tests/bench/scenes; import-scenes). Settings
// take turns on every frame; times are processor time, medians of ratios.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/support/changed_tiles.hpp"
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

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / double(values.size());
}

/// One setting on one scene.
struct Run {
  ScaledIntrinsic method;
  Params params;
  Decomposition now, before;
  std::vector<double> cost, lmse;

  Run(DeviceSession& session, Extent extent, const Params& with)
      : method(session.device(), extent), params(with) {}
  void step(DeviceSession& session, const TruthFrame& frame, bool reset,
            const std::vector<uint8_t>& changed = {}) {
    Cost spent;
    before = std::move(now);
    now = session.run(
        frame.input,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          const bool repeated = !changed.empty() && std::none_of(changed.begin(), changed.end(),
                                                                 [](uint8_t c) { return c != 0; });
          return method.record(commands, input, params, {reset, changed, repeated});
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

void half(DeviceSession& session, const Scene& scene, size_t frames) {
  const Extent extent{uint32_t(scene.frames[0].input.width),
                      uint32_t(scene.frames[0].input.height)};
  Params full, small, looking, chosen;
  full.tolerances.half = 0;
  small.half_resolution = true;
  looking.tolerances.half = 1e-6F;  // compares without changing the resolution
  Run runs[] = {{session, extent, full},
                {session, extent, small},
                {session, extent, looking},
                {session, extent, chosen}};
  std::vector<double> apart, kept;
  double known = 0;
  size_t halved = 0;
  for (size_t k = 0; k < frames; ++k) {
    const TruthFrame& frame = frame_at(scene, k);
    for (Run& run : runs) run.step(session, frame, k == 0);
    if (known == 0) known = double(runs[2].found().half_distance);
    halved += runs[3].method.stats(runs[3].method.recorded() - 1).halvings;
    if (k < 2) continue;
    apart.push_back(distance(frame.input, runs[0].now.shading, runs[1].now.shading));
    if (k >= 12) kept.push_back(distance(frame.input, runs[0].now.shading, runs[3].now.shading));
    if (k % 3 == 2)
      for (Run& run : runs) run.judge(frame);
  }
  name(scene);
  std::printf("%.3f | %.3f | %.2f | %.4f | %.4f | %zu of %zu | %.3f | %.2f | %.4f |\n", known,
              mean(apart), ratio(runs[0], runs[1]), mean(runs[0].lmse), mean(runs[1].lmse), halved,
              frames, mean(kept), ratio(runs[0], runs[3]), mean(runs[3].lmse));
}

/// Change of reflectance from the frame before, minus that of a run without a switch of resolution.
void crossing(DeviceSession& session, const Scene& scene, size_t) {
  if (!scene.video) return;
  const Extent extent{uint32_t(scene.frames[0].input.width),
                      uint32_t(scene.frames[0].input.height)};
  constexpr size_t kDown = 10, kUp = 20, kEnd = 30;
  Run stays{session, extent, {}}, small{session, extent, {}}, carried{session, extent, {}},
      forgets{session, extent, {}};
  small.params.half_resolution = true;
  for (Run* run : {&stays, &small, &carried, &forgets}) run->params.tolerances.half = 0;
  const auto step_of = [](const Run& run) {  // rms change of ln R's mean channel, scale removed
    double sum = 0, squares = 0, count = 0;
    const auto bright = [](const Image& r, size_t i) {
      return std::log(double(r.data[3 * i]) + double(r.data[3 * i + 1]) +
                      double(r.data[3 * i + 2]) + 0.01);
    };
    for (size_t i = 0; i < run.now.shading.data.size(); ++i) {
      const double d = bright(run.now.reflectance, i) - bright(run.before.reflectance, i);
      sum += d, squares += d * d, ++count;
    }
    return std::sqrt(std::max(squares / count - sum * sum / count / count, 0.0));
  };
  std::vector<double> rows[4];
  for (size_t k = 0; k < kEnd; ++k) {
    const TruthFrame& frame = frame_at(scene, k);
    carried.params.half_resolution = forgets.params.half_resolution = k >= kDown && k < kUp;
    for (Run* run : {&stays, &small, &carried}) run->step(session, frame, k == 0);
    forgets.step(session, frame, k == 0 || k == kDown || k == kUp);
    if (k < kDown - 2) continue;
    const Run* all[] = {&stays, &small, &carried, &forgets};
    for (size_t i = 0; i < 4; ++i) rows[i].push_back(step_of(*all[i]));
  }
  name(scene);
  const auto show = [&](const std::vector<double>& row) {
    const size_t down = 2, up = down + kUp - kDown;
    std::printf("%.3f, %.3f, %.3f, %.3f; %.3f, %.3f, %.3f, %.3f | ", row[down - 1], row[down],
                row[down + 1], row[down + 2], row[up - 1], row[up], row[up + 1], row[up + 2]);
  };
  for (const auto& row : rows) show(row);
  std::printf("\n");
}

/// All skipping, relative to none: median over frames in turn, its upper 95 % bound (bootstrap),
/// and the ratio of sums, including comparisons of resolutions.
void adaptive(DeviceSession& session, const Scene& scene, size_t frames) {
  const Extent extent{uint32_t(scene.frames[0].input.width),
                      uint32_t(scene.frames[0].input.height)};
  Params off;
  off.adaptive = false;
  Run all{session, extent, off}, some{session, extent, {}};
  std::vector<double> ratios;
  double costs[2] = {};
  for (size_t k = 0; k < frames; ++k) {
    const TruthFrame& frame = frame_at(scene, k);
    for (Run* run : {k % 2 ? &all : &some, k % 2 ? &some : &all}) run->step(session, frame, k == 0);
    if (k < 2) continue;
    ratios.push_back(some.cost.back() / all.cost.back());
    costs[0] += all.cost.back(), costs[1] += some.cost.back();
  }
  std::mt19937 random(1);
  std::vector<double> medians;
  for (int i = 0; i < 1000; ++i) {
    std::vector<double> drawn;
    for (size_t j = 0; j < ratios.size(); ++j) drawn.push_back(ratios[random() % ratios.size()]);
    medians.push_back(median(drawn));
  }
  std::sort(medians.begin(), medians.end());
  name(scene);
  std::printf("%.3f | %.3f | %.3f |\n", median(ratios), medians[950], costs[1] / costs[0]);
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
    const auto changed = k > 0 ? changed_tiles(before.input, frame.input) : std::vector<uint8_t>();
    all.step(session, frame, k == 0);
    for (size_t i = 0; i < some.size(); ++i) {
      some[i]->step(session, frame, k == 0, changed);
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

/// Settings of little work and the presets to compare with: time relative to quality=medium, and
/// error.
void cheap(DeviceSession& session, const Scene& scene, size_t frames) {
  const Extent extent{uint32_t(scene.frames[0].input.width),
                      uint32_t(scene.frames[0].input.height)};
  struct Candidate {
    size_t halvings;
    uint32_t cycles, warm;
    float edge, cycle;
  };
  constexpr Candidate kCandidates[] = {
      {0, 4, 2, 0.05F, 0.01F}, {1, 4, 2, 0.05F, 0.01F},  {1, 3, 1, 0.1F, 0.01F},
      {1, 2, 1, 0.1F, 0.01F},  {2, 8, 4, 0.05F, 0.003F}, {2, 4, 2, 0.1F, 0.01F},
      {2, 3, 1, 0.1F, 0.01F},  {2, 2, 1, 0.2F, 0.01F},   {2, 1, 1, 0.2F, 0.01F}};
  std::vector<std::unique_ptr<Run>> runs;
  for (const Candidate& c : kCandidates) {
    Params params;
    params.tolerances.half = 0, params.set_halvings(c.halvings);
    params.cycles = c.cycles, params.warm_cycles = c.warm;
    params.tolerances.edge = c.edge, params.tolerances.cycle = c.cycle;
    runs.push_back(std::make_unique<Run>(session, extent, params));
  }
  const size_t count = scene.video ? frames : scene.frames.size();
  for (size_t k = 0; k < count; ++k) {
    const TruthFrame& frame = scene.video ? frame_at(scene, k) : scene.frames[k];
    for (auto& run : runs) {
      run->step(session, frame, k == 0 || !scene.video);
      if (!scene.video || k % 3 == 2) run->judge(frame);
    }
  }
  name(scene);
  for (const auto& run : runs) std::printf("%.2f %.4f | ", ratio(*runs[0], *run), mean(run->lmse));
  std::printf("\n");
}

void run(int argc, char** argv) {
  std::string what = argc > 1 ? argv[1] : "";
  const auto measure = what == "terms"      ? terms
                       : what == "half"     ? half
                       : what == "crossing" ? crossing
                       : what == "cheap"    ? cheap
                       : what == "adaptive" ? adaptive
                       : what == "error"    ? error
                                            : nullptr;
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
    throw std::runtime_error(
        "usage: skip-bench terms|half|crossing|cheap|adaptive|error [--frames N] FOLDER…");
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
