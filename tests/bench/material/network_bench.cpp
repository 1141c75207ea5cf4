// SPDX-License-Identifier: LGPL-2.1-or-later
// Time of a network, node by node: network-bench [--runs N] [--size N] [GRAPH.net …]. Without a
// graph: a U-Net and its 3 x 3 convolutions one by one. Needs a Vulkan device.
#include <cstdio>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "kernels/network/graph_file.hpp"
#include "kernels/network/network.hpp"
#include "network_figures.hpp"
#include "tests/bench/support/timing.hpp"
#include "tests/kernels/network/network_builder.hpp"

namespace {

using namespace inverse;
using bench::Clock;

struct Times {
  double run = 0;                             ///< median wall time, milliseconds
  double processor = 0;                       ///< median, of all threads
  std::vector<std::vector<double>> by_stage;  ///< device milliseconds of every run
};

Times measure(const network::Network& net, const std::shared_ptr<gpu::Device>& device, int runs) {
  gpu::Commands commands(device);
  Times times;
  std::vector<double> walls, processor;
  for (int i = -3; i < runs; ++i)
    for (const bool stages : {false, true}) {
      const double before = bench::processor_ms();
      const auto start = Clock::now();
      commands.begin();
      net.record(commands, stages);
      commands.submit();
      commands.wait();
      if (i < 0) continue;
      if (!stages) {
        walls.push_back(bench::milliseconds(Clock::now() - start));
        processor.push_back(bench::processor_ms() - before);
        continue;
      }
      times.by_stage.resize(commands.stages().size());
      for (size_t s = 0; s < commands.stages().size(); ++s)
        times.by_stage[s].push_back(commands.stages()[s].milliseconds);
    }
  times.run = bench::median(walls);
  times.processor = bench::median(processor);
  return times;
}

void report(const std::string& name, network::Graph graph, uint32_t size,
            const std::shared_ptr<gpu::Device>& device, int runs) {
  const std::vector<network::Shape> shapes = bench::shapes_at(graph, size);
  const auto start = Clock::now();
  const network::Network net(device, std::move(graph), shapes);
  gpu::Commands first(device);
  first.begin();
  net.record(first);
  first.submit();
  first.wait();
  const double start_ms = bench::milliseconds(Clock::now() - start);
  const Times times = measure(net, device, runs);
  const double total = bench::gflop(net);
  std::printf(
      "%s at %u x %u: %.2f ms (processor %.2f), %.3f GFLOP, %.1f GFLOP/s; images %.2f MB, weights "
      "%.2f MB, start %.0f ms\n",
      name.c_str(), size, size, times.run, times.processor, total, 1e3 * total / times.run,
      1e-6 * static_cast<double>(net.plan().bytes()),
      1e-6 * static_cast<double>(net.weight_bytes()), start_ms);
  for (size_t s = 0; s < times.by_stage.size(); ++s) {
    const network::Step& step = net.plan().steps[s];
    const network::Shape& out = net.plan().shapes[net.graph().inputs.size() + step.node];
    const double ms = bench::median(times.by_stage[s]), work = bench::gflop(net, step.node);
    std::printf("  %-28s %4u x %4u x %4u %8.3f ms %8.4f GFLOP %7.1f GFLOP/s\n",
                net.graph().nodes[step.node].name.c_str(), out.channels, out.height, out.width, ms,
                work, ms > 0 ? 1e3 * work / ms : 0);
  }
}

/// A single convolution.
network::Graph convolution(uint32_t channels, uint32_t kernel, uint32_t stride) {
  testing::NetworkBuilder b(1);
  b.output(b.convolution(b.input(channels), channels, kernel, stride, network::Activation::relu));
  return b.graph();
}

}  // namespace

int main(int argc, char** argv) {
  bench::NetworkArguments requested;
  if (!requested.read(argc, argv, "network_bench.cpp")) return 2;
  const uint32_t size = requested.size();
  try {
    const auto device = gpu::Device::open();
    std::printf("%s\n", device->name().c_str());
    for (const std::string& path : requested.files)
      report(path, network::load(path), size, device, requested.runs);
    if (!requested.files.empty()) return 0;
    for (const uint32_t channels : {16u, 32u, 64u, 128u}) {
      const uint32_t side = size * 16 / channels;
      report("3 x 3", convolution(channels, 3, 1), side, device, requested.runs);
      report("3 x 3 / 2", convolution(channels, 3, 2), side, device, requested.runs);
      report("1 x 1", convolution(channels, 1, 1), side, device, requested.runs);
    }
    report("U-Net", testing::u_net(3, 1, 16, 4, 1), size, device, requested.runs);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
