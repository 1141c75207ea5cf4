// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lime_models.hpp"

#include "common/error.hpp"
#include "kernels/material/estimate/material.hpp"
#include "kernels/network/graph_file.hpp"

namespace inverse {
namespace {

std::string path_of(const std::string& folder, const char* name) {
  return folder + "/" + name + ".net";
}

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorKind::file, path + ": " + why + "; put a network of training/lime there");
}

network::Graph load_one(const std::string& folder, const char* name, uint32_t in,
                        network::Shape out, uint32_t& side) {
  const std::string path = path_of(folder, name);
  network::Graph graph = network::load(path);
  if (graph.inputs.size() != 1 || graph.outputs.size() != 1)
    refuse(path, "it has not one input and one output");
  const network::Input& input = graph.inputs[0];
  if (!side) side = input.width;
  if (input.channels != in || input.width != side || input.height != side || !side)
    refuse(path, "it takes " + std::to_string(input.channels) + " x " +
                     std::to_string(input.height) + " x " + std::to_string(input.width) +
                     " in place of " + std::to_string(in) + " x " + std::to_string(side) + " x " +
                     std::to_string(side));
  const network::Shape given{in, side, side};
  const auto shapes = [&] {
    try {
      return network::shapes_of(graph, std::span(&given, 1));
    } catch (const Error& error) {
      throw Error(ErrorKind::file, path + ": " + error.what());
    }
  }();
  const network::Shape& got = shapes[graph.outputs[0].value];
  if (!out.height) out.height = out.width = side;
  if (got != out)
    refuse(path, "it gives " + std::to_string(got.channels) + " x " + std::to_string(got.height) +
                     " x " + std::to_string(got.width));
  return graph;
}

}  // namespace

LimeModels LimeModels::load(const std::string& folder) {
  LimeModels m;
  m.segmentation = load_one(folder, "segmentation", 3, {1, 0, 0}, m.side);
  m.specular = load_one(folder, "specular", 4, {1, 0, 0}, m.side);
  m.mirror = load_one(folder, "mirror", 1, {1, 0, 0}, m.side);
  m.albedo = load_one(folder, "albedo", 4, {4, 1, 1}, m.side);
  m.exponent = load_one(folder, "exponent", 2, {Material::kBins, 1, 1}, m.side);
  const size_t inputs = m.exponent.inputs.size(), last = m.exponent.outputs[0].value;
  if (last < inputs || m.exponent.nodes[last - inputs].op != network::Op::softmax)
    refuse(path_of(folder, "exponent"), "it gives no probabilities, as it does not end in Softmax");
  return m;
}

}  // namespace inverse
