// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <filesystem>
#include <fstream>
#include <string>

#include "kernels/network/graph_file.hpp"
#include "tests/kernels/network/network_builder.hpp"

namespace inverse::testing {

/// Networks of random weights in the shape of training/olat's: small, and good for nothing else.
inline network::Graph random_features(unsigned seed, uint32_t channels = 6, uint32_t out = 64) {
  using network::Activation;
  NetworkBuilder b(seed);
  const auto x = b.input(channels);
  const auto fine = b.convolution(x, 8, 3, 1, Activation::relu);
  const auto coarse = b.convolution(fine, 8, 3, 2, Activation::relu);
  const auto wide = b.simple(network::Op::upsample, coarse);
  b.output(b.convolution(b.concat(wide, fine), out, 3));
  return b.graph();
}
inline network::Graph random_light(unsigned seed, uint32_t in = 24, uint32_t hidden = 24,
                                   uint32_t out = 4) {
  NetworkBuilder b(seed);
  const auto x = b.input(in);
  b.output(b.convolution(b.convolution(x, hidden, 1, 1, network::Activation::relu), out, 1));
  return b.graph();
}
inline void write_graph(const network::Graph& graph, const std::string& path) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  const auto bytes = network::to_file(graph);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

}  // namespace inverse::testing
