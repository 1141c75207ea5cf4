// SPDX-License-Identifier: LGPL-2.1-or-later
#include "reuse_policy.hpp"

#include <algorithm>

#include "kernels/gpu/commands.hpp"

namespace inverse {

bool ReusePolicy::old_enough() const { return since_restart_ >= gpu::kFramesInFlight; }

void ReusePolicy::judge(const Params& params, const Found& found) {
  if (found.compared_edges && found.history) restless_ = 2 * found.tiles_evaluated > found.tiles;
  if (found.looked_at_bins) binds_ = found.cut || !(found.binding < params.chroma_tolerance);
  if (found.looked_at_gate) holds_ = !(found.gate < params.hold_tolerance);
}

bool ReusePolicy::may_settle(const Params& params, const std::optional<Found>& found) const {
  if (!old_enough() || !found) return true;  // of what was before a restart nothing follows
  if (found->cycles < found->cycles_recorded) return true;
  // A cycle changes about a third of what the one before it did.
  return found->change < params.settled / 3;
}

void ReusePolicy::choose_mode(Plan& plan, const Params& params, const Frame& frame,
                              const std::optional<Found>& found) {
  // As many tiles as make a cut are none to leave the others out for.
  if (!params.adaptive || params.tile_tolerance <= 0 || !plan.holds || !before_.holds ||
      frame.taken || frame.changed > std::min(kMostChanged, 0.9F * params.cut_fraction)) {
    calm_ = 0;
    return;
  }
  // Tiles left out keep what was decided for them.
  if (!frame.layers_kept || since_restart_ == 0 || (params.chroma && binds_) != before_.bins)
    calm_ = 0;
  plan.mode = Mode::watched;
  if (calm_++ < gpu::kFramesInFlight || !found) return;
  const bool worth =
      static_cast<float>(found->tiles_busy) <= kMostBusy * static_cast<float>(found->tiles);
  if (!worth || !(found->drift <= params.still_tolerance)) return;  // nor for NaN
  plan.mode = Mode::listed;
}

ReusePolicy::Plan ReusePolicy::next(const Params& params, const Frame& frame,
                                    const std::optional<Found>& found) {
  if (since_restart_ == 0) {
    binds_ = holds_ = true;
    restless_ = false;
  } else if (old_enough() && found) {
    judge(params, *found);
  }
  Plan plan;
  plan.stops =
      params.adaptive && params.settled > 0 && (!frame.history || may_settle(params, found));
  plan.compares_edges = params.adaptive && (!restless_ || since_restart_ % kCompareEvery == 0);
  plan.keeps_edges = params.adaptive && (since_restart_ + 1) % kCompareEvery == 0;
  plan.holds = frame.history && (!params.adaptive || holds_);
  choose_mode(plan, params, frame, found);
  listed_ = plan.mode == Mode::listed ? listed_ + 1 : 0;
  plan.all_tiles = listed_ % kAllEvery == kAllEvery - 1;
  // Over tiles that changed alone, there is nothing to be seen of the whole.
  const bool look = plan.mode != Mode::listed && params.adaptive &&
                    (since_restart_ == kLookAgain ||  // the first one with a settled history
                     since_restart_ % (binds_ && holds_ ? kLookEvery : kLookAgain) == 0);
  ++since_restart_;
  plan.bins = params.chroma && (!params.adaptive || binds_ || look);
  plan.looks_at_bins = look && params.chroma;
  plan.looks_at_gate = look && frame.history;
  before_ = plan;
  return plan;
}

}  // namespace inverse
