// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "tests/kernels/gpu_fixture.hpp"

namespace inverse::testing {

/// Even frames of ordinary and extreme values, each once more with a hot pixel.
inline std::vector<Pixels> extreme_frames(Extent extent) {
  std::vector<Pixels> frames;
  for (const float fill : {0.0f, 1.0f, 0.5f, 1.0f / 255, -3.0f, 1e4f, kInf, -kInf, kNan}) {
    frames.emplace_back(4 * extent.pixels(), fill);
    frames.push_back(frames.back());
    frames.back()[4 * (extent.pixels() / 2)] = 1e4f;
  }
  return frames;
}

}  // namespace inverse::testing
