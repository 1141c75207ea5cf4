// SPDX-License-Identifier: LGPL-2.1-or-later
// Time and memory of ThesisDecomposition by stage.
//
//   thesis-bench [--dump IN [--out OUT]] [--size WxH] [--frames N] [--solver pcg|schwarz] [--levels
//   N]
//                [--irls N] [--pcg N] [--keyframes N] [--epsilon E] [--printed]
//
// Without a dump (see frames.hpp) the frames are synthetic; --out writes every frame's intrinsic
// plane (R.rgb, S). Prints medians over the frames after the first.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>

#include "tests/bench/support/frames.hpp"
#include "tests/bench/support/timing.hpp"
#include "thesis_options.hpp"

namespace {

using namespace inverse;
using bench::Clock;
using bench::median;

struct Options {
  ThesisParams params;
  Extent extent{640, 480};
  int frames = 10;
  std::string dump, out;
};

void run(const Options& options) {
  std::vector<bench::RgbaFrame> inputs;
  if (!options.dump.empty()) inputs = bench::read_frames(options.dump);
  const Extent extent = inputs.empty() ? options.extent : inputs.front().extent;
  const int count = inputs.empty() ? std::max(options.frames, 1) : static_cast<int>(inputs.size());
  const auto device = gpu::Device::open();
  const auto opened = Clock::now();
  ThesisDecomposition method(device, extent);
  method.set_params(options.params);
  const auto input =
      gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), gpu::Memory::upload);
  const auto output =
      gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), gpu::Memory::readback);
  gpu::Commands commands(device);
  std::ofstream out;
  if (!options.out.empty()) out.open(options.out, std::ios::binary);
  std::map<std::string, std::vector<double>> stages;
  std::vector<std::string> order;
  std::vector<double> wall;
  for (int t = 0; t < count; ++t) {
    const bench::RgbaFrame frame =
        inputs.empty() ? bench::synthetic_frame(extent, t) : inputs[static_cast<size_t>(t)];
    if (frame.extent != extent) throw std::runtime_error("the frames of a dump have one size");
    std::memcpy(input->map(), frame.pixels.data(), input->bytes());
    const auto start = Clock::now();
    commands.begin();
    Layers layers;
    const uint64_t number = method.record(commands, {extent, input}, layers);
    commands.copy(layers[Role::intrinsic]->buffer, output, output->bytes());
    commands.submit();
    commands.wait();
    const double took = bench::milliseconds(Clock::now() - start);
    if (out.is_open()) bench::write_frame(out, extent, output->map_as<float>());
    if (t == 0) {
      const double first = bench::milliseconds(Clock::now() - opened);
      printf("first frame, pipelines included: %.0f ms, %u dispatches, %d levels\n", first,
             commands.dispatches(), method.stats(number).levels);
      continue;
    }
    wall.push_back(took);
    std::map<std::string, double> sums;
    for (const auto& stage : commands.stages()) {
      if (std::find(order.begin(), order.end(), stage.name) == order.end())
        order.emplace_back(stage.name);
      sums[stage.name] += stage.milliseconds;
    }
    for (const auto& [name, milliseconds] : sums) stages[name].push_back(milliseconds);
  }
  if (!wall.empty()) {
    printf("%ux%u, %d frames: %.1f ms a frame\n", extent.width, extent.height, count, median(wall));
    for (const auto& name : order) printf("  %-16s %8.2f ms\n", name.c_str(), median(stages[name]));
  }
  printf("device memory: %.0f bytes a pixel\n",
         static_cast<double>(device->memory_peak_bytes()) / static_cast<double>(extent.pixels()));
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  bench::Options known = bench::thesis_options(options.params, options.extent, options.dump);
  known["--out"] = bench::text(options.out);
  known["--frames"] = bench::integer(options.frames);
  known["--keyframes"] = bench::integer(options.params.keyframes);
  known["--printed"] = bench::flag([&] { options.params.irls = ThesisParams::Irls::printed; });
  known["--solver"] = {true, [&](const char* value) {
                         const bool schwarz = !strcmp(value, "schwarz");
                         options.params.solver =
                             schwarz ? ThesisParams::Solver::schwarz : ThesisParams::Solver::pcg;
                         return schwarz || !strcmp(value, "pcg");
                       }};
  if (!bench::read(known, argc, argv, "thesis_bench.cpp")) return 2;
  try {
    run(options);
  } catch (const std::exception& error) {
    fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
