// SPDX-License-Identifier: LGPL-2.1-or-later
// When the layers of an unchanged image can be reused: error against the truth once the change by
// the last cycle falls below a bound (repeat-tolerance), compared with further frames.
//
//   reuse-bench --data FOLDER [--frames N]
//
// FOLDER has scenes as flat dumps (import-scenes, own-scenes); the first frame of every still is
// sent N times (default 150). Prints LMSE (k = 20), the mean of reflectance and shading, by regime,
// and in brackets the mean number of frames until the bound; a scene that never reaches it counts
// with its last frame.
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "tests/bench/metrics/metrics.hpp"
#include "tests/bench/support/command_line.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/scene.hpp"

namespace {

using namespace inverse;

constexpr std::array<float, 5> kBounds{0.003F, 0.002F, 0.0015F, 0.001F, 0.0005F};

/// Of one scene, or the sum over several: first frame, frames at the bounds, last frame.
struct Found {
  std::array<double, kBounds.size() + 2> errors{};
  std::array<double, kBounds.size()> frames{};
  int scenes = 0;

  void add(const Found& other) {
    for (size_t k = 0; k < errors.size(); ++k) errors[k] += other.errors[k];
    for (size_t k = 0; k < frames.size(); ++k) frames[k] += other.frames[k];
    scenes += other.scenes;
  }
};

/// Errors of the first frame and of the frame whose layers are reused, as in the element: repeated
/// frames converge at `bound` at the latest. 0 reuses nothing.
struct Kept {
  double first, last;
  int frames;
};

Kept send_again(bench::DeviceSession& session, const bench::TruthFrame& truth, float bound,
                int count) {
  ScaledIntrinsic method(session.device(),
                         {uint32_t(truth.input.width), uint32_t(truth.input.height)});
  ScaledIntrinsic::Params params;
  bench::Decomposition layers;
  const auto send = [&](bool reset) {
    bench::Cost cost;
    layers = session.run(
        truth.input,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method.record(commands, input, params, {reset});
        },
        cost);
  };
  const auto error = [&] {
    return bench::score_lmse(layers.reflectance, layers.shading, truth.reflectance, truth.shading,
                             truth.mask);
  };
  send(true);
  Kept kept{error(), 0, 0};
  params.tolerances.cycle = std::min(params.tolerances.cycle, bound);
  while (kept.frames < count &&
         (kept.frames == 0 || bound == 0 || method.findings(method.recorded() - 1).change >= bound))
    send(false), ++kept.frames;
  kept.last = error();
  return kept;
}

Found measure(bench::DeviceSession& session, const bench::TruthFrame& truth, int count) {
  Found found;
  found.scenes = 1;
  for (size_t k = 0; k < kBounds.size(); ++k) {
    const Kept kept = send_again(session, truth, kBounds[k], count);
    found.errors.front() = kept.first;
    found.errors[k + 1] = kept.last;
    found.frames[k] = kept.frames;
  }
  found.errors.back() = send_again(session, truth, 0, count).last;
  return found;
}

void print(const std::string& name, const Found& found) {
  const double n = found.scenes;
  std::printf("| %s (%d) | %.4f", name.c_str(), found.scenes, found.errors.front() / n);
  for (size_t k = 0; k < kBounds.size(); ++k)
    std::printf(" | %.4f (%.0f)", found.errors[k + 1] / n, found.frames[k] / n);
  std::printf(" | %.4f |\n", found.errors.back() / n);
}

}  // namespace

int main(int argc, char** argv) try {
  std::string data;
  int frames = 150;
  const bench::Options known{{"--data", bench::text(data)}, {"--frames", bench::integer(frames)}};
  if (!bench::read(known, argc, argv, "reuse_bench.cpp") || data.empty() || frames < 1) return 2;
  bench::DeviceSession session("");
  std::map<std::string, Found> regimes;
  for (const bench::Scene& scene : bench::read_scenes(data)) {
    if (scene.video) continue;
    std::fprintf(stderr, "%s %s\n", scene.set.c_str(), scene.name.c_str());
    regimes[scene.regime].add(measure(session, scene.frames.front(), frames));
  }
  std::printf("| | first frame |");
  for (const float bound : kBounds) std::printf(" %g |", double(bound));
  std::printf(" after %d |\n|---|---|", frames);
  for (size_t k = 0; k <= kBounds.size(); ++k) std::printf("---|");
  std::printf("\n");
  for (const auto& [name, found] : regimes) print(name, found);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "reuse-bench: %s\n", error.what());
  return 1;
}
