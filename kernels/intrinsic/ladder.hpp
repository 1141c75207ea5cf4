#pragma once
#include "../ladder.hpp"
#include "scaled_intrinsic.hpp"

namespace inverse {

/// Levels of work of intrinsicdecomp. Only one step changes the resolution, which makes the method
/// forget earlier frames.
const Ladder<ScaledIntrinsic::Params>& intrinsic_ladder();

}  // namespace inverse
