// SPDX-License-Identifier: LGPL-2.1-or-later
// ScaledIntrinsic::warm_up: a short video of small frames that uses every kernel.
#include "warm_up.hpp"

#include <cmath>
#include <vector>

#include "scaled_intrinsic.hpp"

namespace inverse {

PlanePtr warm_up_picture(const std::shared_ptr<gpu::Device>& device, Extent extent, bool gray) {
  auto plane = std::make_shared<Plane>(
      Plane{extent,
            gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels(), gpu::Memory::upload)});
  auto* values = plane->buffer->map_as<float>();
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x, values += 4) {
      const uint32_t tile = x / 13 * 5 + y / 11 * 3;
      const float light = std::exp(-0.006F * static_cast<float>(x + y));
      for (uint32_t c = 0; c < 3; ++c)
        values[c] = light * static_cast<float>(1 + tile * ((gray ? 0 : c) + 2) % 7) / 8;
      values[3] = 1;
    }
  return plane;
}

bool ScaledIntrinsic::warm_up() const {
  bool all = true;
  device_->warm_up_once("ScaledIntrinsic", [&] { all = play_all(); });
  return all;
}

bool ScaledIntrinsic::play_all() const {
  ScaledIntrinsic small(device_, kWarmUpExtent);
  const PlanePtr input = warm_up_picture(device_, kWarmUpExtent);
  const std::vector<uint8_t> nothing_changed(TileList::count(kWarmUpExtent));
  gpu::Commands commands(device_);
  const auto play = [&](const Params& params, int frames, bool tiles) {
    for (int k = 0; k < frames; ++k) {
      commands.begin();
      FrameInfo info;
      if (tiles) info.changed = nothing_changed;
      small.record(commands, input, params, info);
      commands.submit();
      commands.wait();
    }
  };
  // All work, without and with a frame before; the output's scale far from its later value.
  Params params;
  params.tolerances.half = 0;
  params.scale.white_level = 0.3F;
  params.adaptive = false;
  play(params, 2, false);
  // With `adaptive`: measurements of bins and anchor, which are then skipped, cycles that end
  // early, and the comparison of resolutions.
  params.adaptive = true;
  params.tolerances.chroma = 1;
  params.tolerances.half = 1e-6F;
  small.reset();
  small.planner_.compare_next();
  play(params, 5, false);
  // Tiles, while the output's scale moves, with cycles that end early and with all of them.
  params.scale.white_level = 0.9F;
  params.tolerances.chroma = params.tolerances.half = 0;
  play(params, 6, true);
  const IntrinsicDecomposition& full = *small.methods_[0];
  const bool tiles_used = full.stats(full.recorded() - 1).plan.tiles();
  params.tolerances.cycle = 0;
  play(params, 1, true);
  // Other resolutions, and back.
  params.half_resolution = true;
  play(params, 2, false);
  params.quarter_resolution = true;
  play(params, 2, false);
  params.half_resolution = false;
  play(params, 1, false);
  return tiles_used;
}

}  // namespace inverse
