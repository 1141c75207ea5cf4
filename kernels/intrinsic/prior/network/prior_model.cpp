// SPDX-License-Identifier: LGPL-2.1-or-later
#include "prior_model.hpp"

#include <span>
#include <utility>

#include "common/error.hpp"
#include "kernels/network/graph_file.hpp"

namespace inverse {
namespace {

std::string text_of(const network::Shape& shape) {
  return std::to_string(shape.channels) + " x " + std::to_string(shape.height) + " x " +
         std::to_string(shape.width);
}

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw Error(ErrorKind::file, name + ": " + why + "; docs/reference/networks.md says what " +
                                   "a network of the prior takes and gives");
}

void check(const PriorModel& model, const network::Shape& given) {
  const auto shapes = [&] {
    try {
      return network::shapes_of(model.graph, std::span(&given, 1));
    } catch (const Error& error) {
      refuse(model.name, error.what());
    }
  }();
  const network::Shape& got = shapes[model.graph.outputs[0].value];
  const network::Shape expected =
      model.gives_reflectance()
          ? given
          : network::Shape{PriorModel::kOutputs, given.height / 2, given.width / 2};
  if (got != expected)
    refuse(model.name, "of " + text_of(given) + " it makes " + text_of(got) + " in place of " +
                           text_of(expected));
}

}  // namespace

PriorModel::PriorModel(std::string file, network::Graph network)
    : name(std::move(file)), graph(std::move(network)) {
  if (graph.inputs.size() != 1 || graph.outputs.size() != 1)
    refuse(name, "it has not one input and one output");
  const uint32_t channels = graph.inputs[0].channels;
  if (channels != kInputs && channels != kColors)
    refuse(name, "it takes " + std::to_string(channels) + " channels in place of " +
                     std::to_string(kInputs) + " of the guide or " + std::to_string(kColors) +
                     " of an image");
  // Width and height may differ.
  for (uint32_t side = kStep; side <= kMaxSide; side += kStep)
    check(*this, {channels, side, kMaxSide + kStep - side});
}

std::shared_ptr<const PriorModel> PriorModel::load(const std::string& path) {
  return std::make_shared<const PriorModel>(path, network::load(path));
}

}  // namespace inverse
