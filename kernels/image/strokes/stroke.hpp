// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "kernels/image/place.hpp"

namespace inverse {

/// A line drawn over the frame: what lies under it has one shading, or one reflectance (thesis,
/// 4.5), or gets the reflectance `color`, or is selected for other elements. In pixels of the
/// frame, the first one's center at .5; or balls in a remembered scene.
struct Stroke {
  enum class Kind : uint8_t { shading, reflectance, recolor, select };
  using Point = Place;
  Kind kind = Kind::shading;
  std::vector<Point> points;  ///< at least one; may be outside of the frame
  float radius = 8;           ///< of the round brush, > 0
  /// Whether it extends to its connected surroundings of similar reflectance (StrokeFill).
  bool fill = false;
  std::array<float, 3> color{};  ///< linear RGB, of Kind::recolor
  /// Of a stroke in the scene, which has no points: center and radius, meters.
  std::vector<std::array<float, 4>> balls{};
  bool in_scene() const { return !balls.empty(); }
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

/// Strokes, each drawn by itself, on a picture that shows their frame: how deep inside of its
/// border a place lies, (radius - d) / border at the distance d from the line, limited to -1…2.
struct StrokePatches {
  /// The surroundings of a stroke: texels along x and y, its first one's place on the picture (in
  /// texels from the picture's corner), and its first one's place in `depths` divided by kAlign.
  struct Patch {
    int32_t left = 0, top = 0;
    uint32_t width = 0, height = 0, first = 0;
  };
  static constexpr uint32_t kAlign = 16;
  uint32_t step = 1;           ///< pixels of the picture along a texel
  std::vector<Patch> patches;  ///< of every stroke
  std::vector<float> depths;   ///< row by row
};

/// Draws strokes for a picture of `extent`, and what lies up to an eighth of its size around it.
/// The border is a quarter of the radius, at least 2 pixels and at most the radius; a stroke's
/// weight is the square of the depth, limited to 0…1. At most kMaxStrokes are drawn. Texels are
/// pixels, but coarser if all strokes together cover more than kMaxCover such pictures.
StrokePatches draw_patches(const StrokeList& list, Extent extent);
constexpr uint64_t kMaxCover = 4;

/// Strokes without effect, by their places in the list, as far as a coarse drawing shows.
struct UselessStrokes {
  std::vector<size_t> outside;  ///< of the frame
  /// Of constant shading or reflectance, wholly under later strokes of the other kind.
  std::vector<size_t> under;
};
UselessStrokes find_useless(const StrokeList& list);

}  // namespace inverse
