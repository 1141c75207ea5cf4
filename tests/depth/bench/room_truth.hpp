// SPDX-License-Identifier: LGPL-2.1-or-later
// What is true of the virtual room, to compare strokes in it with.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "kernels/depth/virtual_room/virtual_room.hpp"

namespace inverse::bench {

using Point = std::array<float, 3>;

struct View {
  Extent extent;
  Lens lens;
  Pose pose;
  std::vector<float> depth;
  /// In the world, by the true depth.
  Point point(size_t at) const {
    const auto x = float(at % extent.width), y = float(at / extent.width), z = depth[at];
    return to_world(pose, {z * (x - lens.cx) / lens.fx, z * (y - lens.cy) / lens.fy, z});
  }
};

/// Whether a point lies on the surface of a solid.
inline bool on(const Solid& solid, const Point& point) {
  constexpr float kNear = 0.006F;  // meters
  const float x = point[0] - solid.center[0], y = point[1] - solid.center[1],
              z = point[2] - solid.center[2];
  if (solid.kind == Solid::Kind::ball)
    return std::abs(std::sqrt(x * x + y * y + z * z) - solid.half_size[0]) < kNear;
  const float c = std::cos(solid.turn), s = std::sin(solid.turn);
  const auto inside = [&](float u, float v) {
    return std::abs(u) < solid.half_size[0] + kNear && std::abs(y) < solid.half_size[1] + kNear &&
           std::abs(v) < solid.half_size[2] + kNear;
  };
  return inside(c * x - s * z, s * x + c * z);
}

/// Of what was found with what is true, in pixels.
struct Overlap {
  double both = 0, either = 0, truth = 0;
  void add(bool found, bool meant) {
    both += found && meant;
    either += found || meant;
    truth += meant;
  }
  double iou() const { return both / std::max(either, 1.0); }
};

}  // namespace inverse::bench
