// SPDX-License-Identifier: LGPL-2.1-or-later
#include "repeat_planner.hpp"

#include <algorithm>
#include <utility>

#include "kernels/gpu/frame_ring.hpp"
#include "tolerances.hpp"

namespace inverse {

std::optional<uint64_t> RepeatPlanner::completed(uint64_t number) const {
  if (!first_ || number < *first_ + gpu::kFramesInFlight) return {};
  return number - gpu::kFramesInFlight;
}

RepeatPlanner::Decision RepeatPlanner::next(const Frame& frame) {
  if (!frame.repeated || frame.params_changed || !first_) {
    first_ = frame.number;
    shown_before_ = std::exchange(shown_, 0);
  }
  ++shown_;
  if (!frame.adaptive) return {false, kNotAdaptive};
  if (!frame.repeated) return {false, "the picture changed, or is not compared"};
  if (frame.params_changed) return {false, "parameters changed"};
  if (!frame.layers_available) return {false, "the layers of the frame before are not available"};
  if (*first_ == frame.number) return {false, "first frame of this picture"};
  if (shown_ <= std::min(shown_before_, kMaxRepeats))
    return {true, "the video shows each picture several times"};
  if (!frame.converged)
    return {false, completed(frame.number) ? "repeated picture, but its layers have not converged"
                                           : "no frame of this picture is completed yet"};
  return {true, "repeated picture, and its layers have converged"};
}

}  // namespace inverse
