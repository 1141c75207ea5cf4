// SPDX-License-Identifier: LGPL-2.1-or-later
// Records what Planner gets to know of each frame of the adaptivity scenes, and what it plans:
// tests/kernels/reuse/recorded_facts.csv, which plan_test.cpp plays back without a device.
//
//   plan-facts build/tests/bench/scenes > tests/kernels/reuse/recorded_facts.csv
#include <cstdio>
#include <exception>
#include <string>

#include "kernels/intrinsic/intrinsic_decomposition.hpp"
#include "tests/bench/support/device_session.hpp"
#include "tests/bench/support/scene.hpp"

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
  for (size_t k = 0; k < kFrames; ++k) {
    const Image& frame = frames[to_and_fro(k, frames.size())];
    const bool repeated = before && before->data == frame.data;
    Cost cost;
    session.run(
        frame,
        [&](gpu::Commands& commands, const PlanePtr& input) {
          return method.record(commands, input, {}, {.repeated = repeated});
        },
        cost);
    const auto found = method.findings();
    const Plan& plan = found.plan;
    std::printf("%s,%d,%d,%u,%.9g,%d,%u,%u,%.9g,%.9g,%d,%u,%.9g,%d,%d,%d,%d\n", scene.name.c_str(),
                before != nullptr, repeated, found.cycles, double(found.change), found.cut,
                found.tiles, found.tiles_evaluated, double(found.binding), double(found.gate),
                int(plan.edges), plan.cycles, double(plan.cycle_tolerance), plan.compares_pixels,
                plan.bins, plan.measures_bins, plan.measures_gate);
    before = &frame;
  }
}

int main(const std::string& folder) {
  DeviceSession session("");
  std::printf(
      "scene,history,repeated,cycles,change,cut,tiles,tiles_evaluated,binding,gate,edges,"
      "plan_cycles,cycle_tolerance,compares_pixels,bins,measures_bins,measures_gate\n");
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
