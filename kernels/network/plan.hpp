#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "graph.hpp"

namespace inverse::network {

/// An image that a step reads.
struct Source {
  uint32_t value;
  bool upsampled = false;  ///< read as if it were upsampled: the node in between does not run
};

/// One node, with what was fused into its reads.
struct Step {
  uint32_t node;
  std::vector<Source> sources;  ///< of a fused convolution: parts of its input, upsampled first
  /// Where the channels of each source lie in the node's input.
  std::vector<uint32_t> first_channel;
};

/// How a graph runs at one size. A value lies in a buffer of vec4 (four channels each): element 0
/// is zero, then comes channel block by channel block, row by row. Values whose lives do not
/// overlap share a buffer; inputs and outputs have one of their own.
struct Plan {
  static constexpr uint32_t kNowhere = ~0u;

  std::vector<Shape> shapes;        ///< by value
  std::vector<uint32_t> buffer_of;  ///< by value; kNowhere for what is fused away
  std::vector<Step> steps;
  std::vector<uint64_t> elements;  ///< of each buffer

  /// Bytes of all buffers together: the most that is held.
  uint64_t bytes() const;
};

constexpr uint32_t blocks_of(uint32_t channels) { return (channels + 3) / 4; }
constexpr uint64_t elements_of(const Shape& s) {
  return 1 + uint64_t{blocks_of(s.channels)} * s.height * s.width;
}

/// Plans a valid graph for inputs of these sizes. Concatenation and upsampling become reads of the
/// 3 x 3 convolution behind them where nobody else wants their result. Throws as `shapes_of`.
Plan plan(const Graph& graph, std::span<const Shape> inputs);

}  // namespace inverse::network
