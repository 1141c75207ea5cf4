// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the benchmarks of networks: command line and operation counts.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/network/network.hpp"
#include "tests/bench/support/command_line.hpp"

namespace inverse::bench {

/// [--runs N] [--size N] [FILE …]
struct NetworkArguments {
  int runs = 21;   ///< measured, in turn
  int side = 128;  ///< of the image
  std::vector<std::string> files;

  /// False for an unknown word. `options`: additional ones of this benchmark.
  bool read(int argc, char** argv, const char* source, Options options = {}) {
    options.insert({{"--runs", integer(runs)}, {"--size", integer(side)}});
    const bool understood = bench::read(options, argc, argv, source, &files);
    runs = std::max(1, runs);
    side = std::max(1, side);
    return understood;
  }
  uint32_t size() const { return static_cast<uint32_t>(side); }
};

/// 1e9 floating-point operations of a node.
inline double gflop(const network::Network& net, uint32_t node) {
  return 1e-9 * static_cast<double>(network::operations_of(net.graph(), node, net.plan().shapes));
}

/// Of a whole run.
inline double gflop(const network::Network& net) {
  double sum = 0;
  for (const network::Step& step : net.plan().steps) sum += gflop(net, step.node);
  return sum;
}

/// One image of size x size for each input.
inline std::vector<network::Shape> shapes_at(const network::Graph& graph, uint32_t size) {
  std::vector<network::Shape> shapes;
  for (const network::Input& input : graph.inputs) shapes.push_back({input.channels, size, size});
  return shapes;
}

}  // namespace inverse::bench
