// SPDX-License-Identifier: LGPL-2.1-or-later
#include "network_schedule.hpp"

#include <algorithm>

namespace inverse {
namespace {

bool is_watched(const NetworkSchedule::Known& known) { return known.draws || known.finds_light; }

/// Whether the lamps changed, suddenly or slowly.
bool is_relit(const NetworkSchedule::Known& known) {
  const auto beyond = [](const auto& difference, float moved) {
    return difference && difference->mean > NetworkSchedule::kRelit + moved;
  };
  return known.finds_light &&
         (beyond(known.changed, known.moved) ||
          (known.light_changed && beyond(known.light_changed, known.light_changed->moved)));
}

bool is_static(const NetworkSchedule::Params& params, const NetworkSchedule::Known& known) {
  if (!params.adaptive || !known.found || !known.placed) return false;
  // The reference image for layers is missing when drawing begins.
  const bool stale =
      is_watched(known) && (!known.changed || known.changed->largest > NetworkSchedule::kChanged);
  return known.converged && known.moved < ObjectTracker::kMoved && !stale;
}

}  // namespace

NetworkSchedule::Plan NetworkSchedule::next(const Params& params, const Known& known) {
  // A sudden change of lamps is analyzed at once; a continuing one at the regular rate.
  const bool relit = rested_in_place_ && is_relit(known);
  const bool resting = is_static(params, known) && !relit;
  const bool rest = resting && ++rested_ < std::max(params.estimate_interval, uint32_t{1});
  if (!rest) rested_ = 0;
  if (resting || !known.found)
    follow_ = 0;
  else if (relit)
    follow_ = kFollow;
  rested_in_place_ =
      resting || (rested_in_place_ && !relit && known.found && known.moved < ObjectTracker::kMoved);
  // A square without an object has none in an identical frame, unless a result is still in flight.
  const bool again =
      params.adaptive && known.unchanged && !known.found && searched_ == known.square;

  Plan plan;
  plan.static_object = resting;
  plan.segments = !again && (!rest || !known.unchanged);
  plan.estimates = !rest && (known.found || !params.adaptive);
  if (plan.segments) searched_ = known.square;
  if (plan.estimates) {
    plan.light_restarts = known.finds_light && follow_ > 0;
    plan.lights = known.finds_light && (plan.light_restarts || known.views < kEarlyViews ||
                                        estimates_ % kViewEvery == 0);
    if (follow_) --follow_;
    ++estimates_;
  }
  plan.compares = plan.segments && params.adaptive && is_watched(known);
  if (again)
    plan.skipped = "networks: the picture rests and was searched";
  else if (!plan.segments)
    plan.skipped = "networks: the picture rests and its material is known";
  else if (rest)
    plan.skipped = "networks of the material: the object rests and its material is known";
  else if (!plan.estimates)
    plan.skipped = "networks of the material: no object was found";
  return plan;
}

}  // namespace inverse
