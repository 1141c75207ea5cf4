// SPDX-License-Identifier: LGPL-2.1-or-later
// Specification of kernels/depth/memory but for what it calls.
#pragma once
#include <cstdint>
#include <vector>

#include "tests/reference/plane.hpp"

namespace inverse::reference {

/// Meters of depth in steps of `unit`; 0 and 65535 are unknown (0).
std::vector<double> read_depth(const std::vector<uint16_t>& steps, double unit);

/// The mean of 4 x 4 points, evenly in the part of `plane` that a pixel shows, each the pixel that
/// it falls in.
Plane resize(const Plane& plane, int width, int height);

/// What a frame sees: normal and depth of the view of the scene, or of the depth image where the
/// view has none or another surface is in front of it or behind it. 0 where neither has a normal.
Vec4 seen_surface(const Vec4& view, const Vec4& measured);

/// A frame in 16 x 12 cells of its size, rounded down, at least a pixel each: mean ln brightness,
/// and mean of the depth that is known (0: none).
struct Thumbnail {
  std::vector<double> brightness, depth;
};
Thumbnail thumbnail(int width, int height, const std::vector<double>& brightness,
                    const std::vector<double>& depth);

}  // namespace inverse::reference
