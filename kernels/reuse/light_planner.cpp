// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_planner.hpp"

#include <algorithm>

#include "tolerances.hpp"

namespace inverse {

bool LightPlanner::gray(const Frame& frame) {
  if (frame.light_asked) gray_frames_ = 0;
  if (frame.light_asked || !frame.had_color) return false;
  gray_frames_ = *frame.had_color ? 0 : std::min(gray_frames_ + 1, kGrayFrames);
  return gray_frames_ == kGrayFrames;
}

// A number in the reasons.
static_assert(LightPlanner::kRepeats == 12);

const char* LightPlanner::reason_to_measure(const Frame& frame) {
  const auto measure = [&](const char* reason) {
    repeats_ = 0;
    return reason;
  };
  if (!frame.adaptive) return measure(kNotAdaptive);
  if (frame.first) return measure("no previous frame");
  if (!frame.same_params) return measure("parameters changed");
  if (!frame.repeated) return measure("the picture changed");
  if (repeats_ == kRepeats) return nullptr;
  ++repeats_;
  return "repeated picture, but for fewer than 12 frames";
}

LightPlanner::Plan LightPlanner::next(const Frame& frame) {
  Plan plan;
  plan.gray = gray(frame);
  if (plan.gray) {
    repeats_ = 0;
    plan.skipped.emplace_back("indirect light: the scene has no color to find it by");
    return plan;
  }
  if (const char* reason = reason_to_measure(frame)) {
    if (repeats_ == kRepeats) plan.light = Light::measure_keep;
    plan.run.push_back(std::string("color of light: ") + reason);
  } else {
    plan.light = Light::reuse;
    plan.skipped.emplace_back("color of light: repeated picture");
  }
  return plan;
}

}  // namespace inverse
