// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted ONNX models: an Error, or a graph that can be written and read again.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "common/error.hpp"
#include "kernels/network/graph_file.hpp"
#include "tools/onnx/onnx_import.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  network::Graph graph;
  try {
    graph = onnx_import::graph_of(std::as_bytes(std::span(data, size)), "model");
  } catch (const Error&) {
    return 0;
  }
  const auto file = network::to_file(graph);
  if (network::to_file(network::from_file(file, "written")) != file) abort();
  return 0;
}
