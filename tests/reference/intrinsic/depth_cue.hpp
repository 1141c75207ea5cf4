// SPDX-License-Identifier: LGPL-2.1-or-later
// What surfaces of a remembered scene tell of edges. Double precision.
#pragma once
#include <array>
#include <vector>

#include "intrinsic_decomposition.hpp"

namespace inverse::reference {

/// Surfaces that a frame shows, in a size of their own.
struct SeenSurface {
  int width, height;
  std::vector<std::array<double, 3>> normal;  ///< unit length; 0: unknown
  std::vector<double> known_depth;            ///< meters; 0: unknown
  std::vector<double> depth;                  ///< of the frame; 0: unknown
  double focal;                               ///< pixels
};

/// Multiplies the b of each edge by e^(weight (1 - apart) ((1 - t) 1.2 - .5 t)).
///
/// That of an edge of the frame is the one of the edge of the view that is nearest to its middle.
/// On each side of it are three pixels of the view. t = x^2/(1 + x^2), x the
/// difference of the mean normals of both sides over .4 + .2 noise(z) focal/z. apart goes from 0 to
/// 1 as the depth of neighbors among the inner four of these steps by 1.8 to 3 % of z, the smaller
/// depth beside the edge. Pixels whose depth differs from that beside the edge by 3 % for each
/// pixel do not count. The factor is 1 where a surface beside the edge is not known, or if
/// something is in front of both. a is known from
/// a dm only: it counts as (a dm^2 + (a + b)/2 e^2) / (dm^2 + e^2), e = .001.
void apply_depth(const Guide& guide, const SeenSurface& seen, double weight, EdgePrior& prior);

}  // namespace inverse::reference
