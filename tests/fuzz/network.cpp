// SPDX-License-Identifier: LGPL-2.1-or-later
// Untrusted network files with a valid header: an Error, or a graph whose shapes can be computed
// and that is unchanged when written and read again.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "common/error.hpp"
#include "kernels/network/graph_file.hpp"

namespace {

/// The bytes as the body of a file.
std::vector<std::byte> file_of(const uint8_t* data, size_t size) {
  uint64_t hash = 0xcbf29ce484222325;
  for (size_t i = 0; i < size; ++i) hash = (hash ^ data[i]) * 0x100000001b3;
  const struct {
    char magic[8] = {'I', 'N', 'V', 'E', 'R', 'S', 'E', 'N'};
    uint32_t version = 1, zero = 0;
    uint64_t bytes, checksum;
  } header{.bytes = size, .checksum = hash};
  std::vector<std::byte> file(sizeof header + size);
  std::memcpy(file.data(), &header, sizeof header);
  if (size) std::memcpy(file.data() + sizeof header, data, size);
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace inverse;
  network::Graph graph;
  try {
    graph = network::from_file(file_of(data, size), "some.net");
  } catch (const Error&) {
    return 0;
  }
  if (network::to_file(network::from_file(network::to_file(graph), "again")) !=
      network::to_file(graph))
    abort();
  try {
    std::vector<network::Shape> shapes;
    for (const network::Input& input : graph.inputs) shapes.push_back({input.channels, 16, 24});
    if (network::shapes_of(graph, shapes).size() != graph.values()) abort();
  } catch (const Error&) {
  }
  return 0;
}
