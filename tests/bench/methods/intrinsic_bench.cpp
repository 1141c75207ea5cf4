// SPDX-License-Identifier: LGPL-2.1-or-later
// Time and memory of IntrinsicDecomposition by stage and size.
//
//   intrinsic-bench [--frames N] [--size WxH]… [--adaptive 0|1] [--kernels 0|1]
//
// Frames are synthetic. `cold` ones have no history, `warm` ones continue the frame before. With
// --kernels 1 times are per kernel, summed over its dispatches, instead of per stage; the frame as
// a whole then takes longer.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "kernels/intrinsic/intrinsic_decomposition.hpp"
#include "tests/bench/support/frames.hpp"
#include "tests/bench/support/timing.hpp"

namespace {

using namespace inverse;
using bench::Clock;
using bench::median;
using bench::milliseconds;

struct Run {
  std::map<std::string, std::vector<double>> stages;
  std::vector<std::string> order;
  std::vector<double> wall, processor, tiles;
};

void print(const char* name, Extent extent, const Run& run) {
  std::printf("%5ux%-5u %-5s wall %7.2f ms (best %.2f) processor %.2f ms %6.1f ns/pixel |",
              extent.width, extent.height, name, median(run.wall),
              *std::min_element(run.wall.begin(), run.wall.end()), median(run.processor),
              median(run.wall) * 1e6 / static_cast<double>(extent.pixels()));
  for (const auto& stage : run.order)
    std::printf(" %s %.2f/%.2f", stage.c_str(), median(run.stages.at(stage)),
                *std::min_element(run.stages.at(stage).begin(), run.stages.at(stage).end()));
  std::printf(" | tiles evaluated %.0f%%\n", median(run.tiles));
}

Run measure(const std::shared_ptr<gpu::Device>& device, IntrinsicDecomposition& method,
            const IntrinsicDecomposition::Params& params, const std::vector<PlanePtr>& inputs,
            int count, bool warm, bool kernels) {
  Run run;
  gpu::Commands commands(device);
  commands.stage_every_dispatch(kernels);
  for (int i = 0; i < count + 1; ++i) {  // the first one warms up
    const double processor = bench::processor_ms();
    const auto start = Clock::now();
    commands.begin();
    method.record(commands, inputs[static_cast<size_t>(i) % inputs.size()], params, {!warm});
    commands.submit();
    commands.wait();
    const double wall = milliseconds(Clock::now() - start);
    run.tiles.push_back(100.0 * method.findings().tiles_evaluated /
                        method.stats(method.recorded() - 1).tiles);
    if (i == 0) continue;
    run.wall.push_back(wall);
    run.processor.push_back(bench::processor_ms() - processor);
    std::map<std::string, double> sums;
    for (const auto& stage : commands.stages()) {
      if (std::find(run.order.begin(), run.order.end(), stage.name) == run.order.end())
        run.order.emplace_back(stage.name);
      sums[stage.name] += stage.milliseconds;
    }
    for (const auto& [name, time] : sums) run.stages[name].push_back(time);
  }
  return run;
}

}  // namespace

int main(int argc, char** argv) try {
  int count = 15;
  std::vector<Extent> sizes;
  bool kernels = false;
  IntrinsicDecomposition::Params params;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i], value = argv[i + 1];
    if (option == "--frames")
      count = std::max(1, std::atoi(value.c_str()));
    else if (option == "--adaptive")
      params.adaptive = value != "0";
    else if (option == "--kernels")
      kernels = value != "0";
    else if (option == "--size") {
      Extent extent;
      if (std::sscanf(value.c_str(), "%ux%u", &extent.width, &extent.height) != 2)
        throw std::runtime_error("--size WxH");
      sizes.push_back(extent);
    } else {
      throw std::runtime_error("unknown option " + option);
    }
  }
  const auto device = gpu::Device::open();
  std::printf("%s\n", device->name().c_str());
  if (sizes.empty()) sizes = {{320, 240}, {640, 480}, {1280, 720}, {1920, 1080}};
  for (const Extent extent : sizes) {
    std::vector<PlanePtr> inputs;
    for (int i = 0; i < 4; ++i) {
      const bench::RgbaFrame frame = bench::synthetic_frame(extent, i);
      auto buffer =
          gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), gpu::Memory::upload);
      std::memcpy(buffer->map(), frame.pixels.data(), frame.pixels.size() * sizeof(float));
      inputs.push_back(std::make_shared<Plane>(Plane{extent, buffer}));
    }
    const uint64_t before = device->memory_bytes();
    const auto start = Clock::now();
    IntrinsicDecomposition method(device, extent);
    measure(device, method, params, inputs, 0, false, kernels);
    measure(device, method, params, inputs, 0, true, kernels);
    std::printf("%5ux%-5u first frames %.0f ms, %.0f bytes/pixel\n", extent.width, extent.height,
                milliseconds(Clock::now() - start),
                static_cast<double>(device->memory_bytes() - before) /
                    static_cast<double>(extent.pixels()));
    print("warm", extent, measure(device, method, params, inputs, count, true, kernels));
    print("cold", extent, measure(device, method, params, inputs, count, false, kernels));
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "intrinsic-bench: %s\n", error.what());
  return 1;
}
