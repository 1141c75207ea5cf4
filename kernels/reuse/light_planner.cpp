// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_planner.hpp"

#include <algorithm>

#include "kernels/image/tiles/tile_list.hpp"
#include "tolerances.hpp"

namespace inverse {
namespace {

float share_of(const std::vector<uint8_t>& tiles) {
  return static_cast<float>(std::count(tiles.begin(), tiles.end(), 1)) /
         static_cast<float>(tiles.size());
}

}  // namespace

bool LightPlanner::gray(const Frame& frame) {
  if (frame.light_asked) gray_frames_ = 0;
  if (frame.light_asked || !frame.had_color) return false;
  gray_frames_ = *frame.had_color ? 0 : std::min(gray_frames_ + 1, kGrayFrames);
  return gray_frames_ == kGrayFrames;
}

LightPlanner::Light LightPlanner::light(const Frame& frame) {
  const auto measure = [&](uint32_t static_frames) {
    static_frames_ = static_frames;
    return Light::measure;
  };
  if (!frame.adaptive || !frame.same_params || frame.first || frame.changed.empty())
    return measure(0);
  tiles_ = dilate_tiles(frame.changed, frame.columns);
  if (share_of(tiles_) > kMaxChangedTiles) return measure(0);
  if (++static_frames_ < kStaticFrames) return Light::measure;
  if (static_frames_ == kStaticFrames) {
    ever_changed_.assign(tiles_.size(), 0);
    return Light::measure_keep;
  }
  for (size_t i = 0; i < tiles_.size(); ++i) ever_changed_[i] |= tiles_[i];
  if (static_frames_ > kStaticFrames + kReuseFrames || share_of(ever_changed_) > kMaxEverChanged)
    return measure(kStaticFrames - kMeasureFrames);
  return Light::reuse;
}

LightPlanner::Plan LightPlanner::next(const Frame& frame) {
  Plan plan;
  plan.gray = gray(frame);
  if (plan.gray) {
    static_frames_ = 0;
    plan.skipped.emplace_back("indirect light: the scene has no color to find it by");
    return plan;
  }
  plan.light = light(frame);
  if (plan.reused())
    plan.skipped.emplace_back("scene: little changed since its light was measured");
  return plan;
}

}  // namespace inverse
