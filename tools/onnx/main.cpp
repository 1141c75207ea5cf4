// SPDX-License-Identifier: LGPL-2.1-or-later
// inverse-onnx-import MODEL.onnx [GRAPH.net]: converts an ONNX model to the flat file that the
// plugin loads, or, without a second name, describes the model.
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "common/error.hpp"
#include "kernels/network/graph_file.hpp"
#include "onnx_import.hpp"

namespace {

using namespace inverse;

std::vector<char> read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorKind::unsupported, std::string(path) + ": " + std::strerror(errno));
  try {
    return {std::istreambuf_iterator<char>(file), {}};
  } catch (const std::ios_base::failure& failure) {  // a folder, for one
    throw Error(ErrorKind::unsupported,
                std::string(path) + ": it cannot be read: " + failure.code().message());
  }
}

void write(const char* path, const std::vector<std::byte>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw Error(ErrorKind::unsupported, std::string(path) + ": it cannot be written");
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
  const bool help = argc == 2 && !std::strcmp(argv[1], "--help");
  if (help || (argc != 2 && argc != 3)) {
    std::fprintf(help ? stdout : stderr,
                 "usage: %s MODEL.onnx [GRAPH.net]\n"
                 "Makes the file of a network that gst-inverse loads; without its name, says what "
                 "the model is.\n",
                 argv[0]);
    return help ? 0 : 2;
  }
  try {
    std::error_code other;
    if (argc == 3 && std::filesystem::equivalent(argv[1], argv[2], other))
      throw Error(ErrorKind::unsupported,
                  std::string(argv[2]) + ": that is the model itself, which would be lost");
    const std::vector<char> model = read(argv[1]);
    const network::Graph graph = onnx_import::graph_of(std::as_bytes(std::span(model)), argv[1]);
    if (argc == 3)
      write(argv[2], network::to_file(graph));
    else
      describe(argv[1], graph);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
