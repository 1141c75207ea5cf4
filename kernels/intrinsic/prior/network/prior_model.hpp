// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "kernels/network/graph.hpp"

namespace inverse {

/// A network that changes the fitted prior of intrinsicdecomp (docs/reference/networks.md). By the
/// channels of its input it is one of two kinds: of six channels of the guide it makes 12 of half
/// the size, changes of the prior; of an image of three channels, reflectance of the same size.
struct PriorModel {
  static constexpr uint32_t kInputs = 6, kOutputs = 12, kColors = 3;
  /// Width and height of the input are multiples of this.
  static constexpr uint32_t kStep = 16;
  /// Of the picture that the input shows.
  static constexpr uint32_t kMaxSide = 256;

  std::string name;  ///< of its file
  network::Graph graph;

  bool gives_reflectance() const { return graph.inputs[0].channels == kColors; }

  /// Throws Error(file) if the graph does not take and give that at every size, naming the fault.
  PriorModel(std::string name, network::Graph graph);
  /// Reads a .net file. Throws Error(file).
  static std::shared_ptr<const PriorModel> load(const std::string& path);
};

using PriorModelPtr = std::shared_ptr<const PriorModel>;

}  // namespace inverse
