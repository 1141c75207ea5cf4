// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace inverse {

/// The error that skipping work may add, rms log shading, by default. Its means have these shares
/// of it: half resolution .6, unchanged tiles .2 (and as much again until they are recomputed),
/// chroma bins .2, multigrid cycles .1. That of edges (.5, log intensity) and of the temporal
/// anchor (.6, its gate) are changes of what they depend on. Independent errors add up to .8 of it.
inline constexpr float kSkipError = 0.1F;

}  // namespace inverse
