// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <random>

#include "common/error.hpp"
#include "kernels/network/graph_file.hpp"
#include "network_builder.hpp"
#include "tests/expect_error.hpp"
#include "tests/temporary_folder.hpp"

namespace inverse::testing {

using network::Graph;
using network::Op;

namespace {

Graph small_graph() {
  NetworkBuilder b(4);
  const uint32_t image = b.input(3);
  const uint32_t features = b.convolution(image, 5, 3, 2, network::Activation::leaky_relu, .1f);
  b.output(b.simple(Op::softmax, b.dense(b.simple(Op::global_mean, features), 5, 3)));
  return b.graph();
}

/// The error of reading these bytes; empty without one.
std::string read_error(const std::vector<std::byte>& bytes) {
  const std::string text =
      error_of([&] { network::from_file(bytes, "some.net"); }, ErrorKind::file);
  EXPECT_TRUE(text.empty() || text.starts_with("some.net: ")) << text;
  return text;
}

std::string read_error(const std::function<void(Graph&)>& spoil) {
  Graph graph = small_graph();
  spoil(graph);
  return read_error(network::to_file(graph));
}

}  // namespace

TEST(NetworkFile, ComesBackAsItWas) {
  Graph graph = small_graph();
  graph.inputs[0].height = 48;
  const Graph back = network::from_file(network::to_file(graph), "");
  EXPECT_EQ(network::to_file(back), network::to_file(graph));
  EXPECT_EQ(back.weights, graph.weights);
  ASSERT_EQ(back.nodes.size(), graph.nodes.size());
  for (size_t i = 0; i < graph.nodes.size(); ++i) {
    EXPECT_EQ(back.nodes[i].name, graph.nodes[i].name);
    EXPECT_EQ(back.nodes[i].op, graph.nodes[i].op);
    EXPECT_EQ(back.nodes[i].inputs, graph.nodes[i].inputs);
    EXPECT_EQ(back.nodes[i].slope, graph.nodes[i].slope);
    EXPECT_EQ(back.nodes[i].weights, graph.nodes[i].weights);
  }
  EXPECT_EQ(back.inputs[0].channels, 3u);
  EXPECT_EQ(back.inputs[0].height, 48u);
  EXPECT_EQ(back.outputs[0].value, graph.outputs[0].value);
}

TEST(NetworkFile, CutShortIsRefusedWhereverItEnds) {
  const auto bytes = network::to_file(small_graph());
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(read_error({bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size)}), "")
        << size;
}

TEST(NetworkFile, EveryChangedByteIsRefused) {
  const auto bytes = network::to_file(small_graph());
  for (size_t i = 0; i < bytes.size(); ++i) {
    auto changed = bytes;
    changed[i] ^= std::byte{0x41};
    EXPECT_NE(read_error(changed), "") << i;
  }
}

// With a correct checksum, so that the graph itself is parsed: no byte makes it crash,
// hang or eat memory.
TEST(NetworkFile, GraphsOfRandomBytesAreReadOrErrors) {
  const auto bytes = network::to_file(small_graph());
  std::mt19937 random(1);
  for (int i = 0; i < 4000; ++i) {
    auto changed = bytes;
    const size_t at = 32 + random() % (changed.size() - 32);
    const uint32_t word = i % 2 ? random() : ~0u >> random() % 32;
    memcpy(changed.data() + at, &word, std::min<size_t>(4, changed.size() - at));
    uint64_t hash = 0xcbf29ce484222325;
    for (size_t k = 32; k < changed.size(); ++k)
      hash = (hash ^ static_cast<uint64_t>(changed[k])) * 0x100000001b3;
    memcpy(changed.data() + 24, &hash, sizeof hash);
    read_error(changed);
  }
}

TEST(NetworkFile, DamagedFilesAreErrorsWithTheirCause) {
  auto bytes = network::to_file(small_graph());
  bytes[0] = std::byte{'x'};
  expect_contains(read_error(bytes), "inverse-onnx-import");
  bytes = network::to_file(small_graph());
  bytes[8] = std::byte{9};
  expect_contains(read_error(bytes), "version 9");
  bytes = network::to_file(small_graph());
  bytes.back() ^= std::byte{1};
  expect_contains(read_error(bytes), "checksum");
  expect_error(ErrorKind::file, "/nowhere/some.net: it cannot be read: No such file",
               [] { network::load("/nowhere/some.net"); });
}

TEST(NetworkFile, RefusesInvalidGraphs) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto nan = read_error([](Graph& g) { g.weights[7] = kNan; });
  expect_contains(nan, "node 0");
  expect_contains(nan, "a weight is not a finite number");
  const auto bias =
      read_error([](Graph& g) { g.weights.back() = -std::numeric_limits<float>::infinity(); });
  expect_contains(bias, "a bias is not a finite number");
  for (const std::function<void(Graph&)>& spoil : std::vector<std::function<void(Graph&)>>{
           [](Graph& g) { g.nodes[0].op = static_cast<Op>(99); },
           [](Graph& g) {
             g.nodes[0].activation = static_cast<network::Activation>(network::kActivations);
           },
           [](Graph& g) { g.nodes[0].slope = kNan; },
           [](Graph& g) { g.nodes[0].kernel = 5; },
           [](Graph& g) { g.nodes[0].stride = 0; },
           [](Graph& g) { g.nodes[0].dilation = 2; },
           [](Graph& g) { g.nodes[0].op = Op::depthwise; },
           [](Graph& g) { g.nodes[1].op = Op::add; },
           [](Graph& g) { g.nodes[0].channels = 0; },
           [](Graph& g) { g.nodes[0].fan_in = 0; },
           [](Graph& g) { g.nodes[0].fan_in = 1u << 31; },
           [](Graph& g) { g.nodes[0].weights = ~0ull; },
           [](Graph& g) { g.nodes[2].weights = g.nodes[0].weights; },
           [](Graph& g) { g.nodes[1].activation = network::Activation::relu; },
           [](Graph& g) { g.nodes[0].inputs = {}; },
           [](Graph& g) { g.nodes[0].inputs = {1}; },
           [](Graph& g) { g.nodes[2].inputs = {3}; },
           [](Graph& g) { g.weights.pop_back(); },
           [](Graph& g) { g.inputs[0].channels = 0; },
           [](Graph& g) { g.inputs.clear(); },
           [](Graph& g) { g.nodes.clear(); },
           [](Graph& g) { g.outputs.clear(); },
           [](Graph& g) { g.outputs[0].value = 0; },
           [](Graph& g) { g.outputs[0].value = 99; }})
    EXPECT_NE(read_error(spoil), "");
}

TEST(NetworkFile, UnreadableFilesAreNamed) {
  const auto load_error = [](const std::string& path) {
    return error_of([&] { network::load(path); }, ErrorKind::file);
  };
  const TemporaryFolder folder;
  const std::string remedy = "; inverse-onnx-import makes a network file of an ONNX file";
  EXPECT_EQ(load_error(folder.path()), folder.path() + ": it is no file" + remedy);
  const std::string missing = folder / "a.net";
  EXPECT_EQ(load_error(missing),
            missing + ": it cannot be read: No such file or directory" + remedy);
  // Not read to its end.
  const std::string sparse = folder.write("sparse.net", "");
  std::filesystem::resize_file(sparse, uint64_t{20} << 30);
  expect_contains(load_error(sparse), "not a .net file");
}

}  // namespace inverse::testing
