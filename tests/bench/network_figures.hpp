// What the benchmarks of networks share: their command line, and work done.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "network/network.hpp"

namespace inverse::bench {

/// [--runs N] [--size N] [FILE …]
struct NetworkArguments {
  int runs = 21;        ///< measured, in turn
  uint32_t size = 128;  ///< of the image on a side
  std::vector<std::string> files;

  NetworkArguments(int argc, char** argv) {
    for (int i = 1; i < argc; ++i) {
      if (!strcmp(argv[i], "--runs") && i + 1 < argc)
        runs = std::max(1, std::atoi(argv[++i]));
      else if (!strcmp(argv[i], "--size") && i + 1 < argc)
        size = static_cast<uint32_t>(std::max(1, std::atoi(argv[++i])));
      else
        files.emplace_back(argv[i]);
    }
  }
};

/// 1e9 floating-point operations of a node.
inline double gflop(const network::Network& net, uint32_t node) {
  return 1e-9 * static_cast<double>(network::operations_of(net.graph(), node, net.plan().shapes));
}

/// Those of a run.
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
