// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "graph.hpp"

namespace inverse::network {

/// An image read by a step.
struct Source {
  uint32_t value;
  bool upsampled = false;  ///< read as if upsampled: the upsampling node does not run
};

/// One node with the nodes fused into its reads.
struct Step {
  uint32_t node;
  std::vector<Source> sources;  ///< of a fused convolution: parts of its input, the upsampled one
                                ///< first
  /// First channel of each source in the node's input.
  std::vector<uint32_t> first_channel;
};

/// How a graph runs at one size. A value is a buffer of vec4 (four channels each): element 0 is
/// zero, then channel block by channel block, row by row. Values whose lifetimes do not overlap
/// share a buffer; inputs and outputs have their own.
struct Plan {
  static constexpr uint32_t kNowhere = ~0u;

  std::vector<Shape> shapes;        ///< by value
  std::vector<uint32_t> buffer_of;  ///< by value; kNowhere for fused values
  std::vector<Step> steps;
  std::vector<uint64_t> elements;  ///< of each buffer

  /// Bytes of all buffers.
  uint64_t bytes() const;
};

constexpr uint32_t blocks_of(uint32_t channels) { return (channels + 3) / 4; }
constexpr uint64_t elements_of(const Shape& s) {
  return 1 + uint64_t{blocks_of(s.channels)} * s.height * s.width;
}

/// Plans a valid graph for inputs of these sizes. Upsampling and concatenation are fused into the
/// following 3 x 3 convolution if it is their only reader. Throws as `shapes_of`.
Plan plan(const Graph& graph, std::span<const Shape> inputs);

}  // namespace inverse::network
