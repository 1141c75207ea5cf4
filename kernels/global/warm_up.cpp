// SPDX-License-Identifier: LGPL-2.1-or-later
// GlobalIntrinsic::warm_up: short videos of small frames that use every kernel.
#include "kernels/intrinsic/warm_up.hpp"

#include <vector>

#include "global_intrinsic.hpp"

namespace inverse {
namespace {

/// Frames of reused light within which the solve begins to work on tiles.
constexpr int kMaxFrames = 12;
/// A frame whose grid points are closer than eight pixels.
constexpr Extent kDenseGridExtent{160, 120};

}  // namespace

bool GlobalIntrinsic::play_all() {
  const PlanePtr picture = warm_up_picture(device_, extent_),
                 gray = warm_up_picture(device_, extent_, true);
  gpu::Commands commands(device_);
  const auto show = [&](const PlanePtr& frame, const Params& params, const FrameInfo& info) {
    commands.begin();
    record(commands, frame, params, info);
    commands.submit();
    commands.wait();
  };
  const auto now = [&]() -> const Stats& { return stats(recorded_ - 1); };
  Params params;
  params.tolerances.half = 0;
  // With layers, each number of their planes; with the lamps' color; without either.
  for (uint32_t planes = 1; planes <= kIndirectPlanes; ++planes) {
    params.base_colors = static_cast<int>(4 * planes);
    show(picture, params, {true, true});
  }
  params.white_balance = 0.5F;
  show(picture, params, {});
  params.white_balance = 0;
  // A nearly static picture, as if for long: light is kept, then reused, and the solve begins to
  // work on tiles.
  params.tolerances.gate = params.tolerances.chroma = 0;
  params.tolerances.tile = 1;
  show(picture, params, {});
  planner_.assume_static();
  std::vector<uint8_t> changed(TileList::count(extent_));
  changed[0] = 1;
  bool reused = false, tiles = false;
  for (int k = 0; k < kMaxFrames && !tiles; ++k) {
    show(picture, params, {.shares = k % 2 == 0, .changed = changed});
    reused |= now().light.reused();
    tiles = drawn_ != nullptr;
  }
  // Gray, as if for long.
  for (size_t k = 0; k < reports_.size(); ++k) show(gray, params, {k == 0});
  planner_.assume_gray();
  show(gray, params, {});
  return reused && tiles && now().light.gray;
}

bool GlobalIntrinsic::warm_up() const {
  bool all = solve_.warm_up();
  device_->warm_up_once("GlobalIntrinsic", [&] {
    for (const Extent extent : {kWarmUpExtent, kDenseGridExtent})
      all = GlobalIntrinsic(device_, extent).play_all() && all;
  });
  return all;
}

}  // namespace inverse
