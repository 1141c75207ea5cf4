// SPDX-License-Identifier: LGPL-2.1-or-later
#include "seeds.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/edit_selection_object_count.spv.hpp"

namespace inverse {
namespace {

using Point = SelectionStroke::Point;

bool inside(Point p, const std::vector<Point>& line) {
  bool odd = false;
  for (size_t i = 0, j = line.size() - 1; i < line.size(); j = i++) {
    const Point &a = line[i], &b = line[j];
    if ((a[1] > p[1]) != (b[1] > p[1]) &&
        p[0] < a[0] + (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]))
      odd = !odd;
  }
  return odd;
}

/// Squared distance from a stroke's line, which returns to its beginning if it is closed.
float distance2(Point p, const SelectionStroke& stroke) {
  const float open = squared_distance(p, stroke.points);
  return stroke.closed
             ? std::min(open, squared_distance(p, stroke.points.back(), stroke.points.front()))
             : open;
}

/// The cells whose centers may be so near to a stroke, first and last along x or y.
std::pair<uint32_t, uint32_t> cells_near(const SelectionStroke& stroke, size_t axis, float reach,
                                         float cell, uint32_t count) {
  if (stroke.points.empty()) return {0, 0};
  const auto [low, high] =
      std::minmax_element(stroke.points.begin(), stroke.points.end(),
                          [axis](Point a, Point b) { return a[axis] < b[axis]; });
  const auto at = [&](float place) {
    return static_cast<uint32_t>(
        std::clamp(std::floor(place / cell), 0.0F, static_cast<float>(count)));
  };
  return {at((*low)[axis] - reach), std::min(at((*high)[axis] + reach) + 1, count)};
}

}  // namespace

std::vector<uint32_t> draw_seeds(std::span<const SelectionStroke> strokes, Extent drawn,
                                 const CellGrid& grid, std::vector<SeedCells>* cells) {
  using Shader = shaders::edit_selection_object_count;
  std::vector<uint32_t> seeds(grid.cells.pixels());
  std::vector<SeedCells> found(strokes.size());
  std::vector<size_t> owners(grid.cells.pixels());  // of seeds that add or subtract
  const auto side = static_cast<float>(grid.side);
  const float width = side * static_cast<float>(drawn.width) / static_cast<float>(grid.frame.width),
              height =
                  side * static_cast<float>(drawn.height) / static_cast<float>(grid.frame.height);
  for (size_t n = 0; n < strokes.size(); ++n) {
    const SelectionStroke& stroke = strokes[n];
    const uint32_t kind = stroke.subtract ? Shader::kSeedSubtract : Shader::kSeedAdd;
    const bool closed = stroke.closed && stroke.points.size() > 2;
    const float reach = (closed ? 0 : stroke.radius) + .5F * width,
                around = closed && !stroke.subtract ? reach + 2 * width : 0,
                most = std::max(reach, around);
    const auto [left, right] = cells_near(stroke, 0, most, width, grid.cells.width);
    const auto [top, bottom] = cells_near(stroke, 1, most, height, grid.cells.height);
    for (uint32_t y = top; y < bottom; ++y)
      for (uint32_t x = left; x < right; ++x) {
        const Point p{(static_cast<float>(x) + .5F) * width,
                      (static_cast<float>(y) + .5F) * height};
        const float d2 = distance2(p, stroke);
        const size_t at = size_t{y} * grid.cells.width + x;
        uint32_t& seed = seeds[at];
        if (d2 <= reach * reach || (closed && inside(p, stroke.points))) {
          ++found[n].covered;
          if (seed == kind) continue;
          if (seed == Shader::kSeedAdd || seed == Shader::kSeedSubtract) ++found[owners[at]].taken;
          seed = kind;
          owners[at] = n;
        } else if (d2 <= around * around && seed == 0) {
          seed = Shader::kSeedAround;
        }
      }
  }
  if (cells) *cells = std::move(found);
  return seeds;
}

}  // namespace inverse
