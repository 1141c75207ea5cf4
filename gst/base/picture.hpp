#pragma once
#include "image/plane.hpp"

namespace inverse {

/// What a filter wants to be seen where pixels go out.
struct Picture {
  PlanePtr plane;       ///< rgb = linear colour, w = a scalar layer
  bool scalar = false;  ///< draw w as grey instead of rgb
  float gain = 1.0f;    ///< multiplied before clipping to [0, 1]
  bool linear = false;  ///< keep linear values instead of the output's transfer curve
};

}  // namespace inverse
