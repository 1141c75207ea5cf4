// SPDX-License-Identifier: LGPL-2.1-or-later
#include "resolution_planner.hpp"

#include <algorithm>

#include "kernels/gpu/frame_ring.hpp"
#include "tolerances.hpp"

namespace inverse {

void ResolutionPlanner::reset() {
  const auto was = was_;
  *this = {};
  was_ = was;
}

bool ResolutionPlanner::learn(const Params& params, const Found& found) {
  // After a cut nothing is known of the scene: it is compared as soon as the cut is found.
  if (found.cut) {
    const uint64_t apart = was_.value_or(0) > 0 ? kAgain : kAgainAtFull;
    compare_at_ = std::max(since_reset_, compared_at_ ? *compared_at_ + apart : 0);
  }
  if (found.compared) half_distance_ = found.distance;
  fits_ = half_distance_ > 0 && half_distance_ < (fits_ ? 1 : kEnter) * params.half_tolerance;
  if (!found.compared) return false;
  const bool far = !fits_ && half_distance_ > 1.5F * params.half_tolerance;
  compare_at_ = since_reset_ + (far ? kMaxNext : kNext);
  return far;
}

ResolutionPlanner::Choice ResolutionPlanner::next(const Params& params,
                                                  const std::optional<Found>& found) {
  const bool known = found && since_reset_ >= gpu::kFramesInFlight;
  Choice choice{.halvings = params.halvings, .cut = known && found->cut};
  const bool chooses = params.halvings == 0 && params.adaptive && params.half_tolerance > 0;
  if (!chooses)
    fits_ = false;
  else if (known)
    choice.half_rejected = learn(params, *found);
  if (chooses && fits_) choice.halvings = 1;
  choice.crosses = was_ && *was_ != choice.halvings;
  choice.compares = chooses && !choice.crosses && since_reset_ >= compare_at_;
  if (choice.compares) {
    compared_at_ = since_reset_;
    compare_at_ = since_reset_ + kMaxNext;  // until its outcome is known
  }
  if (choice.halvings == 0)
    choice.full_because = !params.adaptive ? kNotAdaptive
                          : !chooses       ? "half-tolerance is 0"
                          : half_distance_ == 0
                              ? "not compared yet"
                              : "half resolution was too far at the last comparison";
  was_ = choice.halvings;
  ++since_reset_;
  return choice;
}

}  // namespace inverse
