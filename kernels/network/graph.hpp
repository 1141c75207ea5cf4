#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace inverse::network {

/// What a node does with its inputs. Images have channels, height and width; a vector is an image
/// of one pixel.
enum class Op : uint32_t {
  convolution,  ///< 3 x 3 (zeros around the image) or 1 x 1, stride 1 or 2
  max_pool,     ///< 2 x 2, stride 2; an odd last row or column is left out
  upsample,     ///< bilinear, twice as large; pixel centers at halves, clamped at the border
  concat,       ///< the channels of the first input, then those of the second
  dense,        ///< of all of the input, channel by channel, row by row
  global_mean,  ///< of every channel: a vector
  softmax,      ///< over the channels, at every pixel
  activation,   ///< nothing but `Node::activation`
};
constexpr uint32_t kOps = 8;

enum class Activation : uint32_t { none, relu, leaky_relu, sigmoid };
constexpr uint32_t kActivations = 4;

/// One operation. Its result is the value of index Graph::inputs.size() + its own index.
struct Node {
  std::string name;  ///< for messages
  Op op = Op::activation;
  std::vector<uint32_t> inputs;  ///< values, all before its own: two for concat, one for others
  Activation activation = Activation::none;  ///< of convolution, dense and activation
  float slope = 0;                           ///< of leaky_relu below zero
  uint32_t kernel = 1;                       ///< convolution: 1 or 3
  uint32_t stride = 1;                       ///< convolution: 1 or 2
  uint32_t fan_in = 0;    ///< convolution: channels of its input; dense: channels x height x width
  uint32_t channels = 0;  ///< of the result: convolution, dense
  /// Where its weights begin in Graph::weights, [channels][fan_in][kernel][kernel]; then
  /// [channels] of bias.
  uint64_t weights = 0;

  bool has_weights() const { return op == Op::convolution || op == Op::dense; }
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
  uint32_t height = 0, width = 0;  ///< that the network was made for, where that is known
};

struct Output {
  std::string name;
  uint32_t value = 0;
};

/// A network, plainly: nodes in an order in which they can run, and their weights. Values are the
/// inputs, then one result a node. Networks have no size of their own but what their dense nodes
/// fix.
struct Graph {
  std::vector<Input> inputs;
  std::vector<Node> nodes;
  std::vector<Output> outputs;
  std::vector<float> weights;

  uint32_t values() const { return static_cast<uint32_t>(inputs.size() + nodes.size()); }
};

/// Sanity of a graph of any origin: indices, counts, ranges, finite weights, which lie one node's
/// behind the other's. Throws
/// Error(unsupported) naming the node, input or output, and what is wrong.
void validate(const Graph& graph);

/// The shapes of all values for inputs of these sizes. Throws Error(unsupported) where they do not
/// fit each other, naming the node and both shapes.
std::vector<Shape> shapes_of(const Graph& graph, std::span<const Shape> inputs);

/// Multiplications and additions of a node (a multiply-add counts two), for these shapes.
uint64_t operations_of(const Graph& graph, uint32_t node, std::span<const Shape> shapes);

}  // namespace inverse::network
