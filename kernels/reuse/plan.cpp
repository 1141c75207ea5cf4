// SPDX-License-Identifier: LGPL-2.1-or-later
#include "plan.hpp"

#include <algorithm>

#include "kernels/gpu/frame_ring.hpp"

namespace inverse {

// A number in the reasons.
static_assert(gpu::kFramesInFlight == 3);

bool Planner::old_enough() const { return since_restart_ >= gpu::kFramesInFlight; }

void Planner::learn(const Params& params, const Found& found) {
  if (found.plan.edges == Plan::Edges::compare && found.plan.history)
    many_edges_change_ = 2 * found.tiles_evaluated > found.tiles;
  if (found.plan.measures_bins)
    bins_matter_ = found.cut || !(found.binding < params.tolerances.chroma);
  if (found.plan.measures_gate) gate_matters_ = !(found.gate < params.tolerances.gate);
}

bool Planner::may_stop(float tolerance, const std::optional<Found>& found) const {
  if (!old_enough() || !found) return true;  // findings before a restart do not count
  if (found->cycles < found->plan.cycles) return true;
  // A cycle changes about a third of what the one before it did.
  return found->change < tolerance / 3;
}

Plan Planner::next(const Params& params, const Frame& frame, const std::optional<Found>& found) {
  if (since_restart_ == 0) {
    bins_matter_ = gate_matters_ = true;
    many_edges_change_ = false;
  } else if (old_enough() && found) {
    learn(params, *found);
  }
  Plan plan;
  plan.history = (frame.history || frame.warm_start) && params.anchor;
  plan.cycles = plan.history ? params.warm_cycles : params.cycles;
  plan.compares_pixels = plan.history && (!params.adaptive || gate_matters_);
  // A picture that stays converges everywhere, and the sooner, the sooner its layers are reused.
  const Tolerances& tolerances = params.tolerances;
  const float tolerance =
      frame.repeated ? std::min(tolerances.cycle, tolerances.repeat) : tolerances.cycle;
  if (params.adaptive && (!plan.history || may_stop(tolerance, found)))
    plan.cycle_tolerance = tolerance;
  if (params.adaptive && (!many_edges_change_ || since_restart_ % kCompareEvery == 0))
    plan.edges = Plan::Edges::compare;
  else if (params.adaptive && (since_restart_ + 1) % kCompareEvery == 0)
    plan.edges = Plan::Edges::all_save;
  const bool measure =
      params.adaptive &&
      (since_restart_ == kMeasureSoon ||  // the first one with a converged history
       since_restart_ % (bins_matter_ && gate_matters_ ? kMeasureEvery : kMeasureSoon) == 0);
  ++since_restart_;
  plan.bins = params.chroma && (!params.adaptive || bins_matter_ || measure);
  plan.measures_bins = measure && params.chroma;
  plan.measures_gate = measure && plan.history;

  const auto skip = [&](const std::string& stage, const char* reason) {
    plan.skipped.push_back(stage + ": " + reason);
  };
  const auto run = [&](const std::string& stage, const char* reason) {
    plan.run.push_back(stage + ": " + reason);
  };
  if (!plan.history)
    skip("temporal anchor", frame.history ? "its weight is 0" : "no previous frame");
  else if (!plan.compares_pixels)
    skip("temporal anchor of pixels", "its gate is closed");
  else
    run("temporal anchor of pixels", plan.measures_gate ? "its gate is measured"
                                     : params.adaptive  ? "its gate is not known to be closed"
                                                        : kNotAdaptive);
  if (!plan.bins)
    skip("chroma bins",
         params.chroma ? "their effect is below its tolerance" : "their weight is 0");
  else
    run("chroma bins", plan.measures_bins ? "their effect is measured"
                       : params.adaptive  ? "their effect is not known to be below its tolerance"
                                          : kNotAdaptive);
  if (plan.edges == Plan::Edges::all || plan.edges == Plan::Edges::all_save)
    run("edges of all tiles", params.adaptive ? "most of them changed" : kNotAdaptive);
  if (!plan.stops())
    run("all cycles", !params.adaptive ? kNotAdaptive
                      : tolerance > 0  ? "they did not end early three frames ago"
                                       : "cycle-tolerance is 0");
  return plan;
}

}  // namespace inverse
