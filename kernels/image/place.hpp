// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "plane.hpp"

namespace inverse {

/// A place on a frame, x and y in pixels. The center of the first one is at .5.
using Place = std::array<float, 2>;

/// A place in pixels of `from`, in those of `to`; the same if one of the two is empty.
inline Place scaled(Place place, Extent from, Extent to) {
  if (from.pixels() == 0 || to.pixels() == 0 || from == to) return place;
  return {place[0] * static_cast<float>(to.width) / static_cast<float>(from.width),
          place[1] * static_cast<float>(to.height) / static_cast<float>(from.height)};
}

/// Squared distance of a place from the line between two others; NaN if one of them is.
inline float squared_distance(Place p, Place from, Place to) {
  const float dx = to[0] - from[0], dy = to[1] - from[1], length = dx * dx + dy * dy;
  const float along =
      length > 0 ? std::clamp(((p[0] - from[0]) * dx + (p[1] - from[1]) * dy) / length, 0.0F, 1.0F)
                 : 0;
  const float x = p[0] - from[0] - along * dx, y = p[1] - from[1] - along * dy;
  return x * x + y * y;
}

/// The same from a line through places; infinite if none of its parts is finite.
inline float squared_distance(Place p, std::span<const Place> line) {
  float least = std::numeric_limits<float>::infinity();
  for (size_t i = 0; i < line.size(); ++i)
    least = std::min(least, squared_distance(p, line[i > 0 ? i - 1 : 0], line[i]));
  return least;
}

}  // namespace inverse
