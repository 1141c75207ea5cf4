// SPDX-License-Identifier: LGPL-2.1-or-later
// Systems of a Gauss–Newton step of globalintrinsicthesis
// (tests/thesis/reference/global_thesis_energy.hpp), put to the kernels as they are.
#pragma once
#include <vector>

#include "tests/extremes/support/problem.hpp"

namespace inverse::extremes {

/// Adds such systems, from well-conditioned to hopeless ones. Four base colors, so that no layer is
/// empty; nothing is sampled.
void add_global_thesis(std::vector<Problem>& problems);

}  // namespace inverse::extremes
