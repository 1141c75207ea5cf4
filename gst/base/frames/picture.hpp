// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/image/plane.hpp"

namespace inverse {

/// What a filter draws if pixels go out.
struct Picture {
  PlanePtr plane;       ///< rgb = linear color, w = a scalar layer
  bool scalar = false;  ///< draw w as gray instead of rgb
  float gain = 1.0f;    ///< multiplies linear light before clipping to [0, 1]
};

}  // namespace inverse
