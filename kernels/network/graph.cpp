// SPDX-License-Identifier: LGPL-2.1-or-later
#include "graph.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"

namespace inverse::network {
namespace {

constexpr size_t kMaxNodes = 4096;
constexpr size_t kMaxPorts = 64;  // inputs of a graph, and outputs
constexpr uint32_t kMaxChannels = 1 << 16;
constexpr uint32_t kMaxSide = 1 << 14;

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw Error(ErrorKind::unsupported, "network: " + what + ": " + why);
}

std::string text(const Shape& s) {
  return std::to_string(s.channels) + " x " + std::to_string(s.height) + " x " +
         std::to_string(s.width);
}

std::string named(const Node& node) { return "node \"" + node.name + "\""; }

/// `from`: end of the weights of the nodes before. Weights are not shared between nodes, so that a
/// file cannot declare more weights than it contains.
void validate_weights(const Graph& graph, const Node& node, uint64_t from) {
  if (node.channels < 1 || node.channels > kMaxChannels)
    refuse(named(node), std::to_string(node.channels) + " channels");
  if (node.fan_in < 1) refuse(named(node), "no input channels");
  const uint64_t count = node.weight_count() + node.channels;
  if (node.weights > graph.weights.size() || count > graph.weights.size() - node.weights)
    refuse(named(node),
           "its weights are outside of the graph's " + std::to_string(graph.weights.size()));
  if (node.weights < from)
    refuse(named(node), "its weights do not lie behind those of the nodes before it");
  const auto first = graph.weights.begin() + static_cast<ptrdiff_t>(node.weights);
  const auto finite = [](float w) { return std::isfinite(w); };
  const auto bias = first + static_cast<ptrdiff_t>(node.weight_count());
  if (!std::all_of(first, bias, finite)) refuse(named(node), "a weight is not a finite number");
  if (!std::all_of(bias, bias + node.channels, finite))
    refuse(named(node), "a bias is not a finite number");
}

void validate_node(const Graph& graph, uint32_t index, uint64_t& weights_from) {
  const Node& node = graph.nodes[index];
  if (static_cast<uint32_t>(node.op) >= kOps) refuse(named(node), "an unknown operation");
  if (static_cast<uint32_t>(node.activation) >= kActivations)
    refuse(named(node), "an unknown activation");
  if (node.activation != Activation::none && !node.has_weights() && node.op != Op::activation)
    refuse(named(node), "an activation where none is taken");
  if (!std::isfinite(node.slope)) refuse(named(node), "its slope is not a finite number");
  const size_t inputs = node.op == Op::concat || node.op == Op::add ? 2 : 1;
  if (node.inputs.size() != inputs)
    refuse(named(node),
           std::to_string(node.inputs.size()) + " inputs, not " + std::to_string(inputs));
  for (const uint32_t input : node.inputs)
    if (input >= graph.inputs.size() + index)
      refuse(named(node), "it takes a value that is not there yet");
  const bool depthwise = node.op == Op::depthwise,
             strides = depthwise || node.op == Op::convolution;
  const bool small = node.kernel == 1 && !depthwise, large = node.kernel == 3 && strides;
  if (!small && !large) refuse(named(node), "a kernel of size " + std::to_string(node.kernel));
  if (node.stride != 1 && !(node.stride == 2 && strides))
    refuse(named(node), "a stride of " + std::to_string(node.stride));
  if (node.dilation < 1 || node.dilation > (depthwise ? kMaxDilation : 1))
    refuse(named(node), "a dilation of " + std::to_string(node.dilation));
  if (depthwise && node.fan_in != 1)
    refuse(named(node), std::to_string(node.fan_in) + " input channels for each of its own");
  if (!node.has_weights()) return;
  validate_weights(graph, node, weights_from);
  weights_from = node.weights + node.weight_count() + node.channels;
}

/// Checks that an image has the number of channels that a node requires.
void expect_channels(const Node& node, uint64_t got) {
  if (got != node.fan_in)
    refuse(named(node),
           "it takes " + std::to_string(node.fan_in) + " channels and gets " + std::to_string(got));
}

Shape shape_of(const Node& node, std::span<const Shape> values) {
  const Shape in = values[node.inputs[0]];
  switch (node.op) {
    case Op::convolution:
      expect_channels(node, in.channels);
      return {node.channels, (in.height - 1) / node.stride + 1, (in.width - 1) / node.stride + 1};
    case Op::depthwise:
      if (in.channels != node.channels)
        refuse(named(node), "it takes " + std::to_string(node.channels) + " channels and gets " +
                                std::to_string(in.channels));
      return {node.channels, (in.height - 1) / node.stride + 1, (in.width - 1) / node.stride + 1};
    case Op::add: {
      const Shape more = values[node.inputs[1]];
      if (more != in && more != Shape{in.channels, 1, 1})
        refuse(named(node), text(in) + " and " + text(more) + " cannot be added");
      return in;
    }
    case Op::max_pool:
      if (in.height < 2 || in.width < 2) refuse(named(node), text(in) + " is too small to pool");
      return {in.channels, in.height / 2, in.width / 2};
    case Op::upsample:
      return {in.channels, in.height * 2, in.width * 2};
    case Op::concat: {
      const Shape more = values[node.inputs[1]];
      if (in.height != more.height || in.width != more.width)
        refuse(named(node), text(in) + " and " + text(more) +
                                " are of different sizes; sides of the input must be multiples of "
                                "two for every level of the network");
      return {in.channels + more.channels, in.height, in.width};
    }
    case Op::dense:
      if (in.size() != node.fan_in)
        refuse(named(node),
               "it takes " + std::to_string(node.fan_in) + " numbers and gets " + text(in));
      return {node.channels, 1, 1};
    case Op::global_mean:
      return {in.channels, 1, 1};
    case Op::softmax:
    case Op::activation:
      return in;
  }
  refuse(named(node), "an unknown operation");
}

}  // namespace

void validate(const Graph& graph) {
  if (graph.inputs.empty() || graph.inputs.size() > kMaxPorts)
    refuse("graph", std::to_string(graph.inputs.size()) + " inputs");
  if (graph.outputs.empty() || graph.outputs.size() > kMaxPorts)
    refuse("graph", std::to_string(graph.outputs.size()) + " outputs");
  if (graph.nodes.empty() || graph.nodes.size() > kMaxNodes)
    refuse("graph", std::to_string(graph.nodes.size()) + " nodes");
  for (const Input& input : graph.inputs)
    if (input.channels < 1 || input.channels > kMaxChannels)
      refuse("input \"" + input.name + "\"", std::to_string(input.channels) + " channels");
  uint64_t weights_from = 0;
  for (uint32_t i = 0; i < graph.nodes.size(); ++i) validate_node(graph, i, weights_from);
  for (const Output& output : graph.outputs)
    if (output.value >= graph.values() || output.value < graph.inputs.size())
      refuse("output \"" + output.name + "\"", "it is the result of no node");
}

std::vector<Shape> shapes_of(const Graph& graph, std::span<const Shape> inputs) {
  if (inputs.size() != graph.inputs.size())
    refuse("graph", "it takes " + std::to_string(graph.inputs.size()) + " images and gets " +
                        std::to_string(inputs.size()));
  std::vector<Shape> shapes;
  for (size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].channels != graph.inputs[i].channels || !inputs[i].height || !inputs[i].width)
      refuse("input \"" + graph.inputs[i].name + "\"",
             "it has " + std::to_string(graph.inputs[i].channels) + " channels and gets " +
                 text(inputs[i]));
    if (inputs[i].height > kMaxSide || inputs[i].width > kMaxSide)
      refuse("input \"" + graph.inputs[i].name + "\"", text(inputs[i]) + " is too large");
    shapes.push_back(inputs[i]);
  }
  for (const Node& node : graph.nodes) {
    shapes.push_back(shape_of(node, shapes));
    const Shape& s = shapes.back();
    if (s.channels > kMaxChannels || s.height > kMaxSide || s.width > kMaxSide)
      refuse(named(node), text(s) + " is too large");
  }
  return shapes;
}

uint64_t operations_of(const Graph& graph, uint32_t node, std::span<const Shape> shapes) {
  const Node& n = graph.nodes[node];
  const Shape& out = shapes[graph.inputs.size() + node];
  const Shape& in = shapes[n.inputs[0]];
  switch (n.op) {
    case Op::convolution:
    case Op::dense:
    case Op::depthwise:
      return 2 * n.weight_count() * out.height * out.width;
    case Op::max_pool:
      return 3 * out.size();
    case Op::upsample:
      return 7 * out.size();
    case Op::global_mean:
      return in.size();
    case Op::softmax:
      return 3 * in.size();
    case Op::concat:
      return 0;
    case Op::activation:
    case Op::add:
      return out.size();
  }
  return 0;
}

}  // namespace inverse::network
