// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "common/error.hpp"
#include "kernels/network/graph_file.hpp"
#include "network_builder.hpp"
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

/// What reading these bytes complains of; empty if it does not.
std::string complaint(const std::vector<std::byte>& bytes) {
  try {
    network::from_file(bytes, "some.net");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::file);
    EXPECT_EQ(std::string(error.what()).rfind("some.net: ", 0), 0u) << error.what();
    return error.what();
  }
  return "";
}

std::string complaint(const std::function<void(Graph&)>& spoil) {
  Graph graph = small_graph();
  spoil(graph);
  return complaint(network::to_file(graph));
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
    EXPECT_NE(complaint({bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size)}), "") << size;
}

TEST(NetworkFile, EveryChangedByteIsRefused) {
  const auto bytes = network::to_file(small_graph());
  for (size_t i = 0; i < bytes.size(); ++i) {
    auto changed = bytes;
    changed[i] ^= std::byte{0x41};
    EXPECT_NE(complaint(changed), "") << i;
  }
}

// With a correct checksum, so that the graph itself is parsed: no byte makes it crash,
// hang or eat memory.
TEST(NetworkFile, NoGraphOfRandomBytesIsTrusted) {
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
    complaint(changed);
  }
}

TEST(NetworkFile, SaysWhatIsWrong) {
  auto bytes = network::to_file(small_graph());
  bytes[0] = std::byte{'x'};
  EXPECT_NE(complaint(bytes).find("inverse-onnx-import"), std::string::npos);
  bytes = network::to_file(small_graph());
  bytes[8] = std::byte{9};
  EXPECT_NE(complaint(bytes).find("version 9"), std::string::npos);
  bytes = network::to_file(small_graph());
  bytes.back() ^= std::byte{1};
  EXPECT_NE(complaint(bytes).find("checksum"), std::string::npos);
  try {
    network::load("/nowhere/some.net");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/some.net: it cannot be read: No such file"),
              std::string::npos);
  }
}

TEST(NetworkFile, RefusesGraphsThatAreNone) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const auto nan = complaint([](Graph& g) { g.weights[7] = kNan; });
  EXPECT_NE(nan.find("node 0"), std::string::npos) << nan;
  EXPECT_NE(nan.find("a weight is not a finite number"), std::string::npos) << nan;
  const auto bias =
      complaint([](Graph& g) { g.weights.back() = -std::numeric_limits<float>::infinity(); });
  EXPECT_NE(bias.find("a bias is not a finite number"), std::string::npos) << bias;
  for (const std::function<void(Graph&)>& spoil : std::vector<std::function<void(Graph&)>>{
           [](Graph& g) { g.nodes[0].op = static_cast<Op>(99); },
           [](Graph& g) { g.nodes[0].activation = static_cast<network::Activation>(4); },
           [](Graph& g) { g.nodes[0].slope = kNan; },
           [](Graph& g) { g.nodes[0].kernel = 5; },
           [](Graph& g) { g.nodes[0].stride = 0; },
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
    EXPECT_NE(complaint(spoil), "");
}

TEST(NetworkFile, WhatCannotBeReadIsNamed) {
  const auto complaint_of = [](const std::string& path) -> std::string {
    try {
      network::load(path);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
      return error.what();
    }
    return "";
  };
  const TemporaryFolder folder;
  const std::string remedy = "; inverse-onnx-import makes a network file of an ONNX file";
  EXPECT_EQ(complaint_of(folder.path()), folder.path() + ": it is no file" + remedy);
  const std::string missing = folder / "a.net";
  EXPECT_EQ(complaint_of(missing),
            missing + ": it cannot be read: No such file or directory" + remedy);
}

}  // namespace inverse::testing
