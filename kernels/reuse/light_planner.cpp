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

// A number in the reasons.
static_assert(LightPlanner::kStaticFrames == 12);

const char* LightPlanner::reason_to_measure(const Frame& frame) {
  const auto measure = [&](uint32_t static_frames, const char* reason) {
    static_frames_ = static_frames;
    return reason;
  };
  if (!frame.adaptive) return measure(0, kNotAdaptive);
  if (frame.first) return measure(0, "no previous frame");
  if (!frame.same_params) return measure(0, "parameters changed");
  if (frame.changed.empty()) return measure(0, "which tiles changed is unknown");
  tiles_ = dilate_tiles(frame.changed, frame.columns);
  if (share_of(tiles_) > kMaxChangedTiles) return measure(0, "too many tiles changed");
  if (++static_frames_ <= kStaticFrames) {
    if (static_frames_ == kStaticFrames) ever_changed_.assign(tiles_.size(), 0);
    return "few tiles changed, but for fewer than 12 frames";
  }
  for (size_t i = 0; i < tiles_.size(); ++i) ever_changed_[i] |= tiles_[i];
  if (static_frames_ > kStaticFrames + kReuseFrames)
    return measure(kStaticFrames - kMeasureFrames, "reused for its maximum number of frames");
  if (share_of(ever_changed_) > kMaxEverChanged)
    return measure(kStaticFrames - kMeasureFrames, "too many tiles changed since the last time");
  return nullptr;
}

LightPlanner::Plan LightPlanner::next(const Frame& frame) {
  Plan plan;
  plan.gray = gray(frame);
  if (plan.gray) {
    static_frames_ = 0;
    plan.skipped.emplace_back("indirect light: the scene has no color to find it by");
    return plan;
  }
  if (const char* reason = reason_to_measure(frame)) {
    if (static_frames_ == kStaticFrames) plan.light = Light::measure_keep;
    plan.run.push_back(std::string("color of light: ") + reason);
  } else {
    plan.light = Light::reuse;
    plan.skipped.emplace_back("color of light: little changed since it was measured");
  }
  return plan;
}

}  // namespace inverse
