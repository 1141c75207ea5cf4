// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "kernels/intrinsic/prior/network/prior_model.hpp"
#include "tests/kernels/network/network_builder.hpp"

namespace inverse::testing {

/// A small network of the prior with random weights; `gain` scales its output.
inline network::Graph prior_graph(unsigned seed, float gain = 1) {
  using network::Activation;
  NetworkBuilder b(seed);
  const auto convolve = [&](uint32_t from, uint32_t channels, uint32_t stride) {
    return b.convolution(from, channels, 3, stride, Activation::leaky_relu, .1F);
  };
  const uint32_t fine = convolve(b.input(PriorModel::kInputs), 8, 2);
  const uint32_t coarse = convolve(convolve(fine, 12, 2), 12, 1);
  const uint32_t both = b.concat(b.simple(network::Op::upsample, coarse), fine);
  b.output(b.convolution(convolve(both, 12, 1), PriorModel::kOutputs, 1));
  network::Graph graph = b.graph();
  for (size_t i = graph.nodes.back().weights; i < graph.weights.size(); ++i)
    graph.weights[i] *= gain;
  return graph;
}
/// A small network that estimates reflectance, with random weights.
inline PriorModelPtr reflectance_model(unsigned seed) {
  using network::Activation;
  NetworkBuilder b(seed);
  const uint32_t image = b.input(PriorModel::kColors),
                 fine = b.convolution(image, 8, 3, 2, Activation::leaky_relu, .1F),
                 both = b.concat(b.simple(network::Op::upsample, fine), image);
  b.output(b.convolution(both, PriorModel::kColors, 3, 1, Activation::sigmoid));
  return std::make_shared<const PriorModel>("reflectance " + std::to_string(seed), b.graph());
}
inline PriorModelPtr prior_model(unsigned seed, float gain = 1) {
  return std::make_shared<const PriorModel>("network " + std::to_string(seed),
                                            prior_graph(seed, gain));
}

}  // namespace inverse::testing
