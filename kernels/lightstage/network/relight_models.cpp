// SPDX-License-Identifier: LGPL-2.1-or-later
#include "relight_models.hpp"

#include <algorithm>

#include "common/error.hpp"
#include "kernels/network/graph_file.hpp"

namespace inverse {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw Error(ErrorKind::file, name + ": " + why + "; put a network of training/olat there");
}

/// Weights and bias of a 1 x 1 convolution of this shape.
void take(const network::Graph& graph, size_t index, uint32_t in, uint32_t out,
          network::Activation activation, const std::string& name, float* weights, float* bias) {
  const network::Node& node = graph.nodes[index];
  if (node.op != network::Op::convolution || node.kernel != 1 || node.stride != 1 ||
      node.fan_in != in || node.channels != out || node.activation != activation)
    refuse(name, "layer \"" + node.name + "\" is not the " + std::to_string(in) + " to " +
                     std::to_string(out) + " channels of a 1 x 1 convolution" +
                     (activation == network::Activation::relu ? " with ReLU" : "") +
                     " that belongs there");
  const auto from = graph.weights.begin() + static_cast<ptrdiff_t>(node.weights);
  const auto count = static_cast<ptrdiff_t>(in) * out;
  std::copy(from, from + count, weights);
  std::copy(from + count, from + count + out, bias);
}

void check_features(const network::Graph& graph, const std::string& name) {
  if (graph.inputs.size() != 1 || graph.outputs.size() != 1)
    refuse(name, "it has not one input and one output");
  const network::Shape given{6, RelightModels::kStep, 2 * RelightModels::kStep};
  network::Shape got;
  try {
    got = network::shapes_of(graph, std::span(&given, 1))[graph.outputs[0].value];
  } catch (const Error& error) {
    throw Error(ErrorKind::file, name + ": " + error.what());
  }
  const network::Shape wanted{4 * RelightModels::kPlanes, given.height, given.width};
  if (got != wanted)
    refuse(name, "of 6 channels and 64 x 32 pixels it makes " + std::to_string(got.channels) +
                     " channels and " + std::to_string(got.width) + " x " +
                     std::to_string(got.height) + " in place of " +
                     std::to_string(wanted.channels) + " and 64 x 32");
}

}  // namespace

RelightModels RelightModels::of(network::Graph features, const network::Graph& light,
                                const std::string& name) {
  if (light.inputs.size() != 1 || light.outputs.size() != 1 || light.nodes.size() != 2)
    refuse(name, "it is not two layers with one input and one output");
  RelightModels models;
  models.inner.resize(size_t{kHidden} * (kPlanes + kHarmonics));
  take(light, 0, kPlanes + kHarmonics, kHidden, network::Activation::relu, name,
       models.inner.data(), models.inner_bias.data());
  take(light, 1, kHidden, kOut, network::Activation::none, name, models.outer.data(),
       models.outer_bias.data());
  models.features = std::move(features);
  return models;
}

RelightModels RelightModels::load(const std::string& folder) {
  const std::string features = folder + "/features.net", light = folder + "/light.net";
  network::Graph graph = network::load(features);
  check_features(graph, features);
  return of(std::move(graph), network::load(light), light);
}

std::array<double, RelightModels::kHarmonics> RelightModels::harmonics(const Direction& w) {
  const auto& [x, y, z] = w;
  return {x, y, z, x * y, y * z, z * x, x * x - y * y, 3 * z * z - 1};
}

std::array<float, RelightModels::kHidden> RelightModels::bias_for(const Direction& light) const {
  const auto phi = harmonics(light);
  std::array<float, kHidden> result;
  for (size_t j = 0; j < kHidden; ++j) {
    double sum = inner_bias[j];
    for (size_t m = 0; m < kHarmonics; ++m)
      sum += inner[j * (kPlanes + kHarmonics) + kPlanes + m] * phi[m];
    result[j] = static_cast<float>(sum);
  }
  return result;
}

}  // namespace inverse
