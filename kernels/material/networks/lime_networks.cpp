// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lime_networks.hpp"

#include <span>
#include <utility>

namespace inverse {
namespace {

network::Network make(const std::shared_ptr<gpu::Device>& device, network::Graph& graph,
                      uint32_t side) {
  const network::Shape shape{graph.inputs[0].channels, side, side};
  return {device, std::move(graph), std::span(&shape, 1)};
}

}  // namespace

LimeNetworks::LimeNetworks(const std::shared_ptr<gpu::Device>& device, Extent extent,
                           LimeModels models)
    : extent_(extent),
      side_(models.side),
      segmentation_(make(device, models.segmentation, side_)),
      specular_(make(device, models.specular, side_)),
      mirror_(make(device, models.mirror, side_)),
      albedo_(make(device, models.albedo, side_)),
      exponent_(make(device, models.exponent, side_)),
      crop_(device),
      drop_foreign_(device),
      to_specular_(device),
      to_mirror_and_albedo_(device),
      to_exponent_(device),
      guided_(device, side_),
      under_(device, side_),
      layers_{{{device, {.found = false}}, {device, {.found = true}}}},
      planes_(device, extent) {}

uint64_t LimeNetworks::bytes() const {
  uint64_t sum = 0;
  for (const network::Network* net : {&segmentation_, &specular_, &mirror_, &albedo_, &exponent_})
    sum += net->plan().bytes() + net->weight_bytes();
  return sum;
}

void LimeNetworks::record_mask(gpu::Commands& commands, const Plane& frame, const Square& square) {
  commands.dispatch(crop_, {.frame = frame.buffer, .image = picture()},
                    {.size = extent_,
                     .corner = {square.x, square.y},
                     .pixels = square.size / static_cast<float>(side_),
                     .side = static_cast<int32_t>(side_)},
                    {side_ * side_});
  segmentation_.record(commands);
  new_mask_ = true;
  commands.stage("segmentation");
}

void LimeNetworks::record_foreign(gpu::Commands& commands, const gpu::BufferPtr& foreign) {
  commands.dispatch(drop_foreign_, {.probability = probability(), .foreign = foreign},
                    {.count = static_cast<int32_t>(side_ * side_)}, {side_ * side_});
}

void LimeNetworks::record_material(gpu::Commands& commands) {
  const auto points = static_cast<int32_t>(side_ * side_);
  const gpu::Items items{side_ * side_};
  commands.dispatch(
      to_specular_,
      {.image = picture(), .probability = probability(), .result = specular_.input(0)},
      {.count = points}, items);
  specular_.record(commands);
  commands.stage("specular");
  commands.dispatch(to_mirror_and_albedo_,
                    {.masked = specular_.input(0),
                     .specular = specular_.output(0),
                     .mirror_in = mirror_.input(0),
                     .albedo_in = albedo_.input(0)},
                    {.count = points}, items);
  mirror_.record(commands);
  commands.stage("mirror");
  commands.dispatch(to_exponent_,
                    {.masked = specular_.input(0),
                     .specular = mirror_.input(0),
                     .mirror = mirror_.output(0),
                     .result = codes()},
                    {.count = points}, items);
  under_.record(commands, specular_.input(0), codes());
  commands.stage("under-highlights");
  albedo_.record(commands);
  commands.stage("albedo");
  exponent_.record(commands);
  new_codes_ = true;
  commands.stage("exponent");
}

LimeNetworks::Layers LimeNetworks::record_layers(gpu::Commands& commands, const Plane& frame,
                                                 const Square& square) {
  if (new_mask_) guided_.record_mask(commands, picture(), probability());
  if (new_codes_) guided_.record_specular(commands, specular_.input(0), codes());
  if (new_mask_ || new_codes_) commands.stage("guided-layers");
  new_mask_ = new_codes_ = false;
  return draw(commands, frame, square, true);
}

LimeNetworks::Layers LimeNetworks::record_bare_layers(gpu::Commands& commands, const Plane& frame) {
  return draw(commands, frame, {}, false);
}

LimeNetworks::Layers LimeNetworks::draw(gpu::Commands& commands, const Plane& frame,
                                        const Square& square, bool known) {
  Layers layers{planes_.acquire(), planes_.acquire()};
  commands.dispatch_rows(layers_[known],
                         {.frame = frame.buffer,
                          .planes = guided_.mask(),
                          .codes = codes(),
                          .lines = guided_.specular(),
                          .under = under_.diffuse(),
                          .diffuse = gpu::by_rows(layers.diffuse->buffer),
                          .gloss = gpu::by_rows(layers.gloss->buffer)},
                         {.size = extent_,
                          .corner = {square.x, square.y},
                          .pixels = square.size / static_cast<float>(side_),
                          .side = static_cast<int32_t>(side_),
                          .first_row = 0},
                         {extent_.width, extent_.height});
  commands.stage("layers");
  return layers;
}

}  // namespace inverse
