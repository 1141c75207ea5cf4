#pragma once
#include "../ladder.hpp"
#include "thesis_params.hpp"

namespace inverse {

/// Levels of work of the thesis' method. It runs 4 × 8 iterations there (section 3.6.5) and is
/// shown to converge with 7 × 8.
const Ladder<ThesisParams>& thesis_ladder();

}  // namespace inverse
