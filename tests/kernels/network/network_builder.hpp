// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "kernels/network/graph.hpp"

namespace inverse::testing {

/// Builds graphs with random weights that hold values near 1 however deep the graph.
class NetworkBuilder {
 public:
  explicit NetworkBuilder(unsigned seed) : random_(seed) {}

  uint32_t input(uint32_t channels, uint32_t height = 0, uint32_t width = 0) {
    graph_.inputs.push_back(
        {"input " + std::to_string(graph_.inputs.size()), channels, height, width});
    channels_.push_back(channels);
    return static_cast<uint32_t>(channels_.size() - 1);
  }
  uint32_t convolution(uint32_t from, uint32_t channels, uint32_t kernel, uint32_t stride = 1,
                       network::Activation activation = network::Activation::none,
                       float slope = 0) {
    network::Node node = make(network::Op::convolution, {from}, channels);
    node.kernel = kernel;
    node.stride = stride;
    node.activation = activation;
    node.slope = slope;
    node.fan_in = channels_[from];
    return add_weights(std::move(node));
  }
  uint32_t dense(uint32_t from, uint32_t fan_in, uint32_t channels,
                 network::Activation activation = network::Activation::none) {
    network::Node node = make(network::Op::dense, {from}, channels);
    node.activation = activation;
    node.fan_in = fan_in;
    return add_weights(std::move(node));
  }
  uint32_t depthwise(uint32_t from, uint32_t stride = 1, uint32_t dilation = 1,
                     network::Activation activation = network::Activation::none) {
    network::Node node = make(network::Op::depthwise, {from}, channels_[from]);
    node.kernel = 3;
    node.stride = stride;
    node.dilation = dilation;
    node.activation = activation;
    node.fan_in = 1;
    return add_weights(std::move(node));
  }
  uint32_t sum(uint32_t first, uint32_t second) {
    return add(make(network::Op::add, {first, second}, channels_[first]));
  }
  uint32_t concat(uint32_t first, uint32_t second) {
    return add(make(network::Op::concat, {first, second}, channels_[first] + channels_[second]));
  }
  uint32_t simple(network::Op op, uint32_t from) { return add(make(op, {from}, channels_[from])); }
  uint32_t activation(uint32_t from, network::Activation activation, float slope = 0) {
    network::Node node = make(network::Op::activation, {from}, channels_[from]);
    node.activation = activation;
    node.slope = slope;
    return add(std::move(node));
  }
  void output(uint32_t value) {
    graph_.outputs.push_back({"output " + std::to_string(graph_.outputs.size()), value});
  }
  network::Graph graph() const { return graph_; }

 private:
  network::Node make(network::Op op, std::vector<uint32_t> inputs, uint32_t channels) const {
    network::Node node;
    node.name = "node " + std::to_string(graph_.nodes.size());
    node.op = op;
    node.inputs = std::move(inputs);
    node.channels = channels;
    return node;
  }
  uint32_t add(network::Node node) {
    channels_.push_back(node.channels);
    graph_.nodes.push_back(std::move(node));
    return static_cast<uint32_t>(channels_.size() - 1);
  }
  uint32_t add_weights(network::Node node) {
    node.weights = graph_.weights.size();
    const double taps = static_cast<double>(node.fan_in) * node.kernel * node.kernel;
    std::normal_distribution<float> weight(0, static_cast<float>(std::sqrt(2 / taps))),
        bias(0, .1f);
    for (uint64_t i = 0; i < node.weight_count(); ++i) graph_.weights.push_back(weight(random_));
    for (uint32_t i = 0; i < node.channels; ++i) graph_.weights.push_back(bias(random_));
    return add(std::move(node));
  }

  std::mt19937 random_;
  network::Graph graph_;
  std::vector<uint32_t> channels_;  // by value
};

/// A U-Net as an image-to-image network has it: `levels` times down and up again, `width` channels
/// at the top and twice as many a level further down.
inline network::Graph u_net(uint32_t in, uint32_t out, uint32_t width, uint32_t levels,
                            unsigned seed) {
  using network::Activation;
  NetworkBuilder b(seed);
  std::vector<uint32_t> skips;
  uint32_t value = b.input(in), channels = width;
  for (uint32_t level = 0; level < levels; ++level, channels *= 2) {
    value = b.convolution(value, channels, 3, 1, Activation::leaky_relu, .1f);
    skips.push_back(value);
    value = b.convolution(value, channels * 2, 3, 2, Activation::leaky_relu, .1f);
  }
  for (uint32_t level = levels; level-- > 0;) {
    channels /= 2;
    value = b.concat(b.simple(network::Op::upsample, value), skips[level]);
    value = b.convolution(value, channels, 3, 1, Activation::leaky_relu, .1f);
  }
  b.output(b.convolution(value, out, 1, 1, Activation::sigmoid));
  return b.graph();
}

}  // namespace inverse::testing
