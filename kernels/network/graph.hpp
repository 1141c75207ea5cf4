// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace inverse::network {

/// Operation of a node. Images have channels, height and width; a vector is an image of one pixel.
enum class Op : uint32_t {
  convolution,  ///< 3 x 3 (zeros around the image) or 1 x 1, stride 1 or 2
  max_pool,     ///< 2 x 2, stride 2; an odd last row or column is dropped
  upsample,     ///< bilinear, twice as large; pixel centers at halves, clamped at the border
  concat,       ///< channels of the first input, then of the second
  dense,        ///< over the whole input, channel by channel, row by row
  global_mean,  ///< mean of every channel: a vector
  softmax,      ///< over the channels, at every pixel
  activation,   ///< `Node::activation` only
  depthwise,    ///< 3 x 3 of every channel by itself, zeros around the image, stride 1 or 2
  add,          ///< an image and an image of its shape, or a vector of its channels
};
constexpr uint32_t kOps = 10;

enum class Activation : uint32_t { none, relu, leaky_relu, sigmoid, relu6 };
constexpr uint32_t kActivations = 5;
constexpr uint32_t kMaxDilation = 16;

/// One operation. Its result is the value of index Graph::inputs.size() + its own index.
struct Node {
  std::string name;  ///< for messages
  Op op = Op::activation;
  std::vector<uint32_t> inputs;  ///< values before its own: two for concat and add, one for others
  Activation activation = Activation::none;  ///< of nodes with weights, and activation
  float slope = 0;                           ///< of leaky_relu below zero
  uint32_t kernel = 1;                       ///< convolution: 1 or 3; depthwise: 3
  uint32_t stride = 1;                       ///< convolution, depthwise: 1 or 2
  uint32_t dilation = 1;                     ///< depthwise: 1 to kMaxDilation
  /// convolution: channels of its input; dense: channels x height x width; depthwise: 1
  uint32_t fan_in = 0;
  uint32_t channels = 0;  ///< of the result: nodes with weights
  /// Offset of its weights in Graph::weights, [channels][fan_in][kernel][kernel], followed by
  /// [channels] of bias.
  uint64_t weights = 0;

  bool has_weights() const {
    return op == Op::convolution || op == Op::dense || op == Op::depthwise;
  }
  uint64_t weight_count() const { return uint64_t{channels} * fan_in * kernel * kernel; }
};

struct Shape {
  uint32_t channels = 0, height = 0, width = 0;
  bool operator==(const Shape&) const = default;
  uint64_t size() const { return uint64_t{channels} * height * width; }
};

/// An image that the caller provides.
struct Input {
  std::string name;
  uint32_t channels = 0;
  uint32_t height = 0, width = 0;  ///< size that the network was trained for, if known
};

struct Output {
  std::string name;
  uint32_t value = 0;
};

/// A network: nodes in execution order, and their weights. Values are the inputs, then one result
/// per node. The size of the inputs is free unless dense nodes fix it.
struct Graph {
  std::vector<Input> inputs;
  std::vector<Node> nodes;
  std::vector<Output> outputs;
  std::vector<float> weights;

  uint32_t values() const { return static_cast<uint32_t>(inputs.size() + nodes.size()); }
};

/// Validates a graph of any origin: indices, counts, ranges, finite weights stored in node order.
/// Throws Error(unsupported) naming the node, input or output, and the fault.
void validate(const Graph& graph);

/// The shapes of all values for inputs of these sizes. Throws Error(unsupported) if they do not
/// match, naming the node and both shapes.
std::vector<Shape> shapes_of(const Graph& graph, std::span<const Shape> inputs);

/// Floating-point operations of a node for these shapes; a multiply-add counts two.
uint64_t operations_of(const Graph& graph, uint32_t node, std::span<const Shape> shapes);

}  // namespace inverse::network
