// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <span>

#include "graph.hpp"

namespace inverse::network {

/// A network on the processor, by oneDNN, for inputs of one size. Images are in the layout of
/// `Network`: after a vec4 of zeros, channels in blocks of four. Not thread-safe.
class HostNetwork {
 public:
  /// Whether this build has oneDNN; INVERSE_ONEDNN=0 in the environment says no.
  static bool available();
  /// For a valid graph. Throws Error(unsupported) as shapes_of, or if oneDNN cannot run a node,
  /// which it names.
  HostNetwork(const Graph& graph, std::span<const Shape> inputs);
  HostNetwork(HostNetwork&&) noexcept;
  ~HostNetwork();

  /// Runs once: one pointer for each input and each output of the graph.
  void run(std::span<const float* const> inputs, std::span<float* const> outputs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace inverse::network
