// SPDX-License-Identifier: LGPL-2.1-or-later
// Records what Planner gets to know of each frame of the adaptivity scenes, and what it plans:
// tests/kernels/reuse/recorded_facts.csv, which plan_test.cpp plays back without a device.
//
//   plan-facts build/tests/bench/scenes > tests/kernels/reuse/recorded_facts.csv
#include <cstdio>
#include <exception>
#include <numeric>
#include <string>

#include "kernels/image/tiles/tile_list.hpp"
#include "kernels/intrinsic/intrinsic_decomposition.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/scene.hpp"
#include "tests/changed_tiles.hpp"

namespace inverse::bench {
namespace {

constexpr size_t kFrames = 60;

void record(DeviceSession& session, const Scene& scene) {
  const Image& first = scene.frames[0].input;
  const Extent extent{static_cast<uint32_t>(first.width), static_cast<uint32_t>(first.height)};
  IntrinsicDecomposition method(session.device(), extent);
  std::vector<Image> frames;
  for (const TruthFrame& frame : scene.frames) frames.push_back(through_8_bits(frame.input));
  const Image* before = nullptr;
  bool layers = false;
  for (size_t k = 0; k < kFrames; ++k) {
    const Image& frame = frames[to_and_fro(k, frames.size())];
    const auto changed = before ? changed_tiles(size_t(frame.width), size_t(frame.channels),
                                                before->data, frame.data)
                                : std::vector<uint8_t>();
    const auto affected = dilate_tiles(changed, TileList::along(extent.width));
    const auto count = std::accumulate(affected.begin(), affected.end(), 0U);
    const bool repeated = before && count == 0;
    Cost cost;
    session.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method.record(commands, input, {}, {false, changed, repeated});
        },
        cost);
    const auto found = method.findings();
    const Plan& plan = found.plan;
    std::printf(
        "%s,%d,%d,%d,%.9g,%u,%.9g,%d,%u,%u,%.9g,%.9g,%u,%.9g,%d,%d,%d,%u,%.9g,%.9g,%d,%d,%d,%d\n",
        scene.name.c_str(), before != nullptr, layers, repeated,
        before ? double(count) / double(affected.size()) : 1, found.cycles, double(found.change),
        found.cut, found.tiles, found.tiles_evaluated, double(found.binding), double(found.gate),
        found.tiles_moving, double(std::max(found.drift, found.mean_drift / Planner::kMeanDrift)),
        int(plan.mode), plan.all_tiles, int(plan.edges), plan.cycles, double(plan.cycle_tolerance),
        double(plan.tile_tolerance), plan.compares_pixels, plan.bins, plan.measures_bins,
        plan.measures_gate);
    before = &frame;
    layers = !plan.whole();
  }
}

int main(const std::string& folder) {
  DeviceSession session("");
  std::printf(
      "scene,history,layers_reusable,repeated,changed,cycles,change,cut,tiles,tiles_evaluated,"
      "binding,gate,tiles_moving,drift,mode,all_tiles,edges,plan_cycles,cycle_tolerance,"
      "tile_tolerance,compares_pixels,bins,measures_bins,measures_gate\n");
  for (const Scene& scene : read_scenes(folder))
    if (scene.video) record(session, scene);
  return 0;
}

}  // namespace
}  // namespace inverse::bench

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("usage: plan-facts FOLDER");
  return inverse::bench::main(argv[1]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "plan-facts: %s\n", error.what());
  return 1;
}
