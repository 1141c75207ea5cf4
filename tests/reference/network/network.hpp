// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <span>
#include <vector>

#include "kernels/network/graph.hpp"

namespace inverse::reference {

/// An image of a network, [channel][row][column].
struct Image {
  network::Shape shape;
  std::vector<double> data;

  double at(uint32_t c, uint32_t y, uint32_t x) const {
    return data[(size_t{c} * shape.height + y) * shape.width + x];
  }
  double& at(uint32_t c, uint32_t y, uint32_t x) {
    return data[(size_t{c} * shape.height + y) * shape.width + x];
  }
};

/// Every output of a network for these inputs: node by node, in double precision, without fusion.
std::vector<Image> run_network(const network::Graph& graph, std::span<const Image> inputs);

}  // namespace inverse::reference
