// SPDX-License-Identifier: LGPL-2.1-or-later
// GlobalIntrinsic::warm_up: short videos on small frames in which everything comes that can come.
#include "kernels/intrinsic/warm_up.hpp"

#include <vector>

#include "global_intrinsic.hpp"

namespace inverse {
namespace {

/// Frames after light is held within which the solve comes to work on tiles.
constexpr int kSoon = 12;
/// A frame on whose grid points are closer than eight pixels.
constexpr Extent kClose{160, 120};

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
  params.half_bound = 0;
  // With layers, each number of their planes; the lamps' color; without any.
  for (uint32_t planes = 1; planes <= kIndirectPlanes; ++planes) {
    params.base_colors = static_cast<int>(4 * planes);
    show(picture, params, {true, true});
  }
  params.white_balance = 0.5F;
  show(picture, params, {});
  params.white_balance = 0;
  // A picture of which next to nothing changes, as if for long: light is kept, then held, and the
  // solve comes to work on tiles.
  params.hold_tolerance = params.chroma_tolerance = 0;
  params.tile_tolerance = 1;
  show(picture, params, {});
  calm_ = kCalm - 1;
  std::vector<uint8_t> changed(TileList::count(extent_));
  changed[0] = 1;
  bool held = false, listed = false;
  for (int k = 0; k < kSoon && !listed; ++k) {
    show(picture, params, {false, k % 2 == 0, changed});
    held |= now().held;
    listed = drawn_ != nullptr;
  }
  // Gray, as if for long.
  for (size_t k = 0; k < reports_.size(); ++k) show(gray, params, {k == 0});
  gray_ = kRest;
  show(gray, params, {});
  return held && listed && now().plain;
}

bool GlobalIntrinsic::warm_up() const {
  bool all = solve_.warm_up();
  device_->warm_up_once("GlobalIntrinsic", [&] {
    for (const Extent extent : {kWarmUpExtent, kClose})
      all = GlobalIntrinsic(device_, extent).play_all() && all;
  });
  return all;
}

}  // namespace inverse
