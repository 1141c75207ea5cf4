// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernels/image/plane.hpp"

namespace inverse {

/// A line drawn over the frame: what lies under it has one shading, or one reflectance (thesis,
/// 4.5). In pixels of the frame, the first one's center at .5.
struct Stroke {
  enum class Kind : uint8_t { shading, reflectance };
  using Point = std::array<float, 2>;
  Kind kind = Kind::shading;
  std::vector<Point> points;  ///< at least one; may be outside of the frame
  float radius = 8;           ///< of the round brush, > 0
  /// Whether it extends to its connected surroundings of similar reflectance (StrokeFill).
  bool fill = false;
  bool operator==(const Stroke&) const = default;
};

constexpr size_t kMaxStrokes = 64;

/// Whether a point, in pixels of the frame, lies under the brush.
bool covers(const Stroke& stroke, Stroke::Point point);

/// Strokes on frames of one size. Never changed: other strokes are another object.
struct StrokeList {
  std::vector<Stroke> strokes;
  Extent frame;
};
using StrokesPtr = std::shared_ptr<const StrokeList>;  ///< null: no strokes

/// What of a picture strokes cover.
struct StrokeMask {
  /// Of every pixel, in rows padded to packs of four: 0, or the number of its stroke, from 1 on,
  /// plus half of its weight (strokes.glsl).
  std::vector<float> pixels;
  /// Of every stroke, the first cell of 4 x 4 pixels and the one after the last, along x and y;
  /// empty if it covers nothing.
  struct Bounds {
    uint32_t left = 0, top = 0, right = 0, bottom = 0;
  };
  std::vector<Bounds> bounds;
};

/// Draws strokes on a picture of `extent`, which shows their frame. A pixel's weight is
/// min(1, (radius - d) / border)^2 at the distance d from the line, with a border of a quarter of
/// the radius, at least 2 pixels and at most the radius. Where strokes overlap, the later one
/// covers the earlier one unless its weight is smaller. At most kMaxStrokes are drawn.
StrokeMask draw_strokes(const StrokeList& list, Extent extent);

}  // namespace inverse
