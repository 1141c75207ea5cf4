// SPDX-License-Identifier: LGPL-2.1-or-later
// inverse-onnx-import [--overwrite] MODEL.onnx [GRAPH.net]: converts an ONNX model to the flat file
// that the plugin loads, or, without a second name, describes the model.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/open_file.hpp"
#include "common/replace_file.hpp"
#include "kernels/network/graph_file.hpp"
#include "onnx_import.hpp"

namespace {

using namespace inverse;

std::string read(const std::string& path) {
  constexpr uint64_t kMaxBytes = uint64_t{1} << 30;
  const OpenFile file(path);
  std::string fault = file.fault();
  // A message of Protocol Buffers does not start with it: seen before the rest is read.
  char first = 0;
  if (fault.empty() && file.read(0, &first, 1) == 1 && first == 0) fault = "is no ONNX model";
  const std::string model = fault.empty() ? read_file(file, kMaxBytes, fault) : std::string();
  if (!fault.empty()) throw Error(ErrorKind::unsupported, path + ": it " + fault);
  return model;
}

void describe(const char* path, const network::Graph& graph) {
  std::printf("%s: %zu nodes, %zu weights\n", path, graph.nodes.size(), graph.weights.size());
  for (const auto& input : graph.inputs)
    std::printf("  input %s: %u channels, %u x %u\n", input.name.c_str(), input.channels,
                input.height, input.width);
  for (const auto& output : graph.outputs) std::printf("  output %s\n", output.name.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  const char* program = argv[0];
  const bool overwrite = argc > 1 && !std::strcmp(argv[1], "--overwrite");
  if (overwrite) {
    --argc;
    ++argv;
  }
  const bool help = argc == 2 && !std::strcmp(argv[1], "--help");
  if (help || (argc != 2 && argc != 3)) {
    std::fprintf(help ? stdout : stderr,
                 "usage: %s [--overwrite] MODEL.onnx [GRAPH.net]\n"
                 "Makes the file of a network that gst-inverse loads; without its name, says what "
                 "the model is.\nOne that exists is replaced only with --overwrite.\n",
                 program);
    return help ? 0 : 2;
  }
  try {
    std::error_code other;
    if (argc == 3 && std::filesystem::equivalent(argv[1], argv[2], other))
      throw Error(ErrorKind::unsupported,
                  std::string(argv[2]) + ": that is the model itself, which would be lost");
    const std::string model = read(argv[1]);
    const network::Graph graph = onnx_import::graph_of(std::as_bytes(std::span(model)), argv[1]);
    if (argc == 2) {
      describe(argv[1], graph);
      return 0;
    }
    const std::vector<std::byte> bytes = network::to_file(graph);
    write_file(argv[2], {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, overwrite);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
