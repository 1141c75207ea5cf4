// SPDX-License-Identifier: LGPL-2.1-or-later
#include "seeds.hpp"

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

bool covers(const SelectionStroke& stroke, Point p, float reach) {
  return (stroke.closed && stroke.points.size() > 2 && inside(p, stroke.points)) ||
         squared_distance(p, stroke.points) <= reach * reach;
}

}  // namespace

std::vector<uint32_t> draw_seeds(std::span<const SelectionStroke> strokes, Extent drawn,
                                 const CellGrid& grid) {
  using Shader = shaders::edit_selection_object_count;
  std::vector<uint32_t> seeds(grid.cells.pixels());
  const float scale_x = static_cast<float>(drawn.width) / static_cast<float>(grid.frame.width),
              scale_y = static_cast<float>(drawn.height) / static_cast<float>(grid.frame.height);
  const auto side = static_cast<float>(grid.side);
  for (const SelectionStroke& stroke : strokes) {
    const float reach = stroke.radius + .5F * side * scale_x;
    for (uint32_t y = 0; y < grid.cells.height; ++y)
      for (uint32_t x = 0; x < grid.cells.width; ++x)
        if (covers(stroke,
                   {(static_cast<float>(x) + .5F) * side * scale_x,
                    (static_cast<float>(y) + .5F) * side * scale_y},
                   reach))
          seeds[size_t{y} * grid.cells.width + x] =
              stroke.subtract ? Shader::kSeedSubtract : Shader::kSeedAdd;
  }
  return seeds;
}

}  // namespace inverse
