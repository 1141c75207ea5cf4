// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <vector>

#include "kernels/image/plane.hpp"
#include "thesis_params.hpp"

namespace inverse {

/// What of a frame of ThesisDecomposition is run, and what is skipped. A plain value: stages obey
/// it.
struct ThesisPlan {
  int keyframes = 0;                 ///< to draw samples from, beside the frame itself
  bool clustered = false;            ///< the finest level has the cluster prior
  bool store_keyframe = false;       ///< the frame becomes a keyframe
  std::vector<std::string> skipped;  ///< what, and why
};

/// `stored` counts the keyframes and `frames` the frames since the last reset.
ThesisPlan plan_thesis(const ThesisParams& params, int levels, int stored, uint32_t frames);

/// Number of pyramid levels for a frame size: `requested`, or three to five by resolution if that
/// is 0; never more than it takes to reach 1×1.
int thesis_levels(Extent extent, int requested);

}  // namespace inverse
