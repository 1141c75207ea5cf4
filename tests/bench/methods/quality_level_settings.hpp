// SPDX-License-Identifier: LGPL-2.1-or-later
// The quality levels of an element, as points of the benchmark.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "methods.hpp"

namespace inverse::bench {

/// The levels of `table`, for stills (curve "quality") and for videos ("video quality"), including
/// the named qualities. `make(params)` returns a Setting's solvers. Other levels are measured with
/// `others`, in videos with --full and on the project's own scenes only. Params: ScaledIntrinsic's,
/// and those of the method.
template <typename Params, typename MakeOf>
std::vector<Setting> quality_level_settings(const QualityLevels<Params>& table, const MakeOf& make,
                                            Setting::Effort others) {
  std::vector<Setting> all;
  for (std::size_t k = 0; k < table.levels.size(); ++k) {
    Params params;
    table.levels[k].set(params);
    Setting s{.curve = "quality", .order = double(k), .make = make(params)};
    for (const auto& [quality, name] : kQualities)
      if (table.top(quality) == k) s.preset = name;
    s.parameters = {{"half-resolution", params.half_resolution ? "true" : "false"},
                    {"quarter-resolution", params.quarter_resolution ? "true" : "false"},
                    {"cycles", std::to_string(params.cycles)},
                    {"warm-cycles", std::to_string(params.warm_cycles)},
                    {"edge-tolerance", text_of(double(params.tolerances.edge))},
                    {"cycle-tolerance", text_of(double(params.tolerances.cycle))}};
    s.effort = s.preset.empty() ? others : Setting::Effort::brief;
    const std::string half = params.halvings() == 0   ? ""
                             : params.halvings() == 1 ? "half, "
                                                      : "quarter, ";
    s.base = k == table.top(Quality::medium);
    s.name = half + std::to_string(params.cycles);
    // Levels that differ only in temporal settings are equal for stills.
    const bool again = k + 1 < table.levels.size() && [&] {
      Params next;
      table.levels[k + 1].set(next);
      return next.halvings() == params.halvings() && next.cycles == params.cycles;
    }();
    if (!again) all.push_back(s);
    s.curve = "video quality", s.stills = false, s.video = true, s.base = false;
    if (s.preset.empty()) s.effort = Setting::Effort::full, s.sets = {"own"};
    s.name =
        half + std::to_string(params.warm_cycles) + ", " + text_of(double(params.tolerances.edge));
    all.push_back(s);
  }
  return all;
}

}  // namespace inverse::bench
