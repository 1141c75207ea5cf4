// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve_properties.hpp"

#include <string>
#include <utility>

namespace inverse {

bool typical(const ScaledIntrinsic::Stats& solve) { return !solve.crossed && !solve.compared; }

DecompositionMethod::Work solve_work(const ScaledIntrinsic::Stats& solve,
                                     const ScaledIntrinsic::Findings& found) {
  DecompositionMethod::Work work{solve.plan.skipped, solve.plan.run};
  std::string light = SceneLight::skipped(solve.light, found.slope_found);
  if (!light.empty()) work.skipped.push_back(std::move(light));
  return work;
}

void describe_solve(GstStructure* stats, const ScaledIntrinsic::Stats& solve,
                    const ScaledIntrinsic::Findings& found) {
  gst_structure_set(stats, "cycles", G_TYPE_UINT, found.cycles, "levels", G_TYPE_UINT, solve.levels,
                    "halvings", G_TYPE_UINT, static_cast<guint>(solve.halvings), "half-distance",
                    G_TYPE_DOUBLE, static_cast<double>(found.half_distance), "history",
                    G_TYPE_BOOLEAN, solve.plan.history, "cut", G_TYPE_BOOLEAN, found.cut,
                    "mismatch", G_TYPE_DOUBLE, static_cast<double>(found.mismatch), "change",
                    G_TYPE_DOUBLE, static_cast<double>(found.change), "scale", G_TYPE_DOUBLE,
                    static_cast<double>(found.scale), "light-color-slope", G_TYPE_DOUBLE,
                    static_cast<double>(found.slope), "light-color-confidence", G_TYPE_DOUBLE,
                    static_cast<double>(found.slope_confidence), "tiles", G_TYPE_UINT, solve.tiles,
                    "tiles-evaluated", G_TYPE_UINT, found.tiles_evaluated, nullptr);
  gst_structure_set(stats, "prior", G_TYPE_STRING,
                    solve.network ? solve.network->name.c_str() : PriorModels::kFitted, "prior-age",
                    G_TYPE_UINT, solve.network_age, nullptr);
  if (solve.network_runs > 0)
    gst_structure_set(stats, "prior-runs", G_TYPE_UINT, solve.network_runs, nullptr);
  const Tolerances& tolerances = solve.tolerances;
  for (const auto& [name, value] : {std::pair{"half-tolerance", tolerances.half},
                                    {"chroma-tolerance", tolerances.chroma},
                                    {"cycle-tolerance", tolerances.cycle},
                                    {"repeat-tolerance", tolerances.repeat},
                                    {"edge-tolerance", tolerances.edge},
                                    {"gate-tolerance", tolerances.gate}})
    gst_structure_set(stats, name, G_TYPE_DOUBLE, static_cast<double>(value), nullptr);
}

}  // namespace inverse
