// SPDX-License-Identifier: LGPL-2.1-or-later
// Invariants for any input and any parameters.
#pragma once
#include "tests/extremes/support/lab.hpp"
#include "tests/extremes/support/shrink.hpp"

namespace inverse::extremes {

/// Decomposes a case's frames as a video and describes the first fault: layers that are not finite
/// or out of range; layers of intrinsicdecomp that do not multiply to the input or differ from the
/// reference; a model of the thesis' method that does not explain most of the input. `lab` must
/// outlive the check.
Check check_with(const Lab& lab);

/// The first of these for one frame's layers (R.rgb, S).
std::optional<std::string> wrong_layers(const Case& one, uint32_t frame, const Pixels& input,
                                        const Pixels& got);

}  // namespace inverse::extremes
