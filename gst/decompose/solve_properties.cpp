// SPDX-License-Identifier: LGPL-2.1-or-later
#include "solve_properties.hpp"

#include <string>

namespace inverse {

void describe_solve(GstStructure* stats, const ScaledIntrinsic::Stats& solve,
                    const ScaledIntrinsic::Findings& found) {
  std::string skipped;
  for (const auto& reason : solve.skipped) skipped += (skipped.empty() ? "" : "; ") + reason;
  gst_structure_set(
      stats, "cycles", G_TYPE_UINT, found.cycles, "levels", G_TYPE_UINT, solve.levels,
      "half-resolution", G_TYPE_BOOLEAN, solve.halvings > 0, "halvings", G_TYPE_UINT,
      static_cast<guint>(solve.halvings), "half-distance", G_TYPE_DOUBLE,
      static_cast<double>(found.half_distance), "history", G_TYPE_BOOLEAN, solve.history, "cut",
      G_TYPE_BOOLEAN, found.cut, "mismatch", G_TYPE_DOUBLE, static_cast<double>(found.mismatch),
      "change", G_TYPE_DOUBLE, static_cast<double>(found.change), "scale", G_TYPE_DOUBLE,
      static_cast<double>(found.scale), "tiles", G_TYPE_UINT, solve.tiles, "tiles-evaluated",
      G_TYPE_UINT, found.tiles_evaluated, "tiles-active", G_TYPE_UINT, found.tiles_active,
      "skipped", G_TYPE_STRING, skipped.c_str(), nullptr);
}

}  // namespace inverse
