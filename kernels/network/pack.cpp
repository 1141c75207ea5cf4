// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pack.hpp"

#include <algorithm>

namespace inverse::network {
namespace {

/// Weights of one node, indexed as in the graph.
class NodeWeights {
 public:
  NodeWeights(const Graph& graph, const Node& node)
      : node_(node), weights_(graph.weights.data() + node.weights) {}

  /// Zero for a channel that does not exist.
  float weight(uint32_t to, uint32_t from, uint32_t row, uint32_t column) const {
    if (to >= node_.channels) return 0;
    const uint64_t k = node_.kernel;
    return weights_[((uint64_t{to} * node_.fan_in + from) * k + row) * k + column];
  }
  float bias(uint32_t to) const {
    return to < node_.channels ? weights_[node_.weight_count() + to] : 0;
  }

 private:
  const Node& node_;
  const float* weights_;
};

void put_bias(std::vector<float>& packed, const Node& node, const NodeWeights& w) {
  for (uint32_t to = 0; to < 4 * blocks_of(node.channels); ++to) packed.push_back(w.bias(to));
}

std::vector<float> pack_convolution(const Graph& graph, const Plan& plan, const Step& step) {
  const Node& node = graph.nodes[step.node];
  const NodeWeights w(graph, node);
  std::vector<float> packed;
  put_bias(packed, node, w);
  for (uint32_t block = 0; block < blocks_of(node.channels); ++block)
    for (size_t s = 0; s < step.sources.size(); ++s) {
      const uint32_t channels = plan.shapes[step.sources[s].value].channels;
      for (uint32_t from = 0; from < blocks_of(channels); ++from)
        for (uint32_t column = 0; column < node.kernel; ++column)
          for (uint32_t row = 0; row < node.kernel; ++row)
            for (uint32_t c = 4 * from; c < 4 * from + 4; ++c)
              for (uint32_t to = 4 * block; to < 4 * block + 4; ++to)
                packed.push_back(c < channels ? w.weight(to, step.first_channel[s] + c, row, column)
                                              : 0);
    }
  return packed;
}

std::vector<float> pack_depthwise(const Graph& graph, const Node& node) {
  const NodeWeights w(graph, node);
  std::vector<float> packed;
  put_bias(packed, node, w);
  for (uint32_t block = 0; block < blocks_of(node.channels); ++block)
    for (uint32_t row = 0; row < 3; ++row)
      for (uint32_t column = 0; column < 3; ++column)
        for (uint32_t to = 4 * block; to < 4 * block + 4; ++to)
          packed.push_back(w.weight(to, 0, row, column));
  return packed;
}

std::vector<float> pack_dense(const Graph& graph, const Plan& plan, const Step& step) {
  const Node& node = graph.nodes[step.node];
  const NodeWeights w(graph, node);
  const Shape in = plan.shapes[step.sources[0].value];
  const uint32_t area = in.height * in.width;
  std::vector<float> packed;
  put_bias(packed, node, w);
  for (uint32_t block = 0; block < blocks_of(node.channels); ++block)
    for (uint32_t within = 0; within < 4; ++within)
      for (uint32_t c = within; c < 4 * blocks_of(in.channels); c += 4)
        for (uint32_t pixel = 0; pixel < area; ++pixel)
          for (uint32_t to = 4 * block; to < 4 * block + 4; ++to)
            packed.push_back(c < in.channels ? w.weight(to, c * area + pixel, 0, 0) : 0);
  return packed;
}

}  // namespace

std::vector<float> packed_weights(const Graph& graph, const Plan& plan, const Step& step) {
  const Node& node = graph.nodes[step.node];
  if (node.op == Op::dense) return pack_dense(graph, plan, step);
  if (node.op == Op::depthwise) return pack_depthwise(graph, node);
  return pack_convolution(graph, plan, step);
}

}  // namespace inverse::network
