// SPDX-License-Identifier: LGPL-2.1-or-later
#include "prior_network.hpp"

#include <array>
#include <utility>

#include "kernels/image/pyramid.hpp"

namespace inverse {
namespace {

uint32_t padded(uint32_t side) {
  return (side + PriorModel::kStep - 1) / PriorModel::kStep * PriorModel::kStep;
}

network::Network network_of(const std::shared_ptr<gpu::Device>& device, const PriorModel& model,
                            const PriorPicture& picture) {
  const std::array<network::Shape, 1> input{
      {{model.graph.inputs[0].channels, picture.padded.height, picture.padded.width}}};
  return {device, model.graph, input};
}

}  // namespace

PriorPicture::PriorPicture(Extent frame) : extent(frame) {
  for (; std::max(extent.width, extent.height) > PriorModel::kMaxSide; ++level)
    extent = half_of(extent);
  padded = {inverse::padded(extent.width), inverse::padded(extent.height)};
}

PriorNetwork::PriorNetwork(const std::shared_ptr<gpu::Device>& device, Extent frame,
                           PriorModelPtr model)
    : picture_(frame),
      model_(std::move(model)),
      network_(network_of(device, *model_, picture_)),
      input_(device, {.image = model_->gives_reflectance()}),
      fields_(gpu::Buffer::create(device, gpu::Element::vec4, picture_.extent.pixels())) {
  if (model_->gives_reflectance())
    reflectance_.emplace(device);
  else
    output_.emplace(device);
}

void PriorNetwork::record(gpu::Commands& commands, const Guide& guide, uint32_t interval,
                          const TileList* listed) {
  // Fields of an earlier frame must follow, though nothing changes any more.
  if (rate_.age() > 0) listed = nullptr;
  const auto when = [&](const auto& run) {
    if (listed)
      commands.when(listed->words(), 0, run);
    else
      run();
  };
  when([&] {
    commands.dispatch(input_,
                      {.level0 = guide.level0(),
                       .level1 = guide.level1(),
                       .cells = guide.cells(),
                       .statistics = guide.statistics(),
                       .result = network_.input(0)},
                      {.size = guide.extent(),
                       .network = picture_.extent,
                       .padded = picture_.padded,
                       .level = static_cast<int32_t>(picture_.level)},
                      line_of(picture_.padded.pixels()));
    if (!network_.on_host()) network_.record(commands);
  });
  if (network_.on_host()) {
    bool ran = false;
    commands.on_host([&] {
      if (listed && *listed->words()->map_as<uint32_t>() == 0) return;
      const uint64_t blocks = (model_->graph.inputs[0].channels + 3) / 4;
      ran =
          rate_.due({network_.input(0)->map_as<float>() + 4, 4 * blocks * picture_.padded.pixels()},
                    interval);
      if (ran) network_.run();
    });
    if (!ran) return;
  }
  when([&] {
    if (output_)
      commands.dispatch(*output_, {.prior = network_.output(0), .fields = fields_},
                        {.size = picture_.extent, .half_padded = half_of(picture_.padded)},
                        line_of(half_of(picture_.extent).pixels()));
    else
      commands.dispatch(*reflectance_,
                        {.level0 = guide.level0(),
                         .level1 = guide.level1(),
                         .cells = guide.cells(),
                         .reflectance = network_.output(0),
                         .fields = fields_},
                        {.size = guide.extent(),
                         .network = picture_.extent,
                         .padded_width = static_cast<int32_t>(picture_.padded.width),
                         .level = static_cast<int32_t>(picture_.level)},
                        line_of(picture_.extent.pixels()));
  });
}

}  // namespace inverse
