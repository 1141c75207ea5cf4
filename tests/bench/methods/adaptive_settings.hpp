// SPDX-License-Identifier: LGPL-2.1-or-later
// Time saved by skipping, as settings of the benchmark: in videos of some length, each mode is
// compared with "off", which skips nothing.
#pragma once

#include <string>
#include <utility>

#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "tests/bench/support/method.hpp"

namespace inverse::bench {

/// Turns all skipping off.
inline void leave_nothing_out(ScaledIntrinsic::Params& params) {
  params.tolerances.edge = params.tolerances.cycle = params.tolerances.chroma = 0;
  params.tolerances.gate = params.tolerances.half = 0;
}

/// A mode by its name: "off" and "on" are in every run, with enough frames for a ratio within a
/// percent; others, parts of "on", with --full.
inline Setting adaptive_setting(const std::string& name, double order,
                                const ScaledIntrinsic::Params& params,
                                decltype(Setting::make) make) {
  constexpr std::size_t kFrames = 48, kPairs = 72;
  const bool off = name == "off", whole = off || name == "on";
  return {.curve = "adaptive",
          .name = name,
          .order = order,
          .parameters = {{"adaptive", params.adaptive ? "true" : "false"},
                         {"cycle-tolerance", text_of(double(params.tolerances.cycle))},
                         {"edge-tolerance", text_of(double(params.tolerances.edge))}},
          .make = std::move(make),
          .stills = false,
          .video = true,
          .frames = kFrames,
          .min_samples = whole ? kPairs : 0,
          .effort = whole ? Setting::Effort::brief : Setting::Effort::full,
          .against = off ? "" : "adaptive/off"};
}

}  // namespace inverse::bench
