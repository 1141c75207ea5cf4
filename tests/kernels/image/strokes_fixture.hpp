// SPDX-License-Identifier: LGPL-2.1-or-later
// Strokes for the tests, as the reference has them.
#pragma once
#include <vector>

#include "kernels/image/pack4.hpp"
#include "kernels/image/strokes/stroke_mask.hpp"
#include "tests/kernels/gpu_fixture.hpp"
#include "tests/reference/image/strokes.hpp"

namespace inverse::testing {

/// Strokes on a picture of `extent`.
inline std::vector<reference::StrokeLine> reference_lines(const StrokeList& list, Extent extent) {
  const double across = double(extent.width) / list.frame.width,
               down = double(extent.height) / list.frame.height;
  std::vector<reference::StrokeLine> lines;
  for (const Stroke& stroke : list.strokes) {
    reference::StrokeLine line;
    for (const Stroke::Point& p : stroke.points)
      line.points.emplace_back(double(p[0]) * across, double(p[1]) * down);
    line.radius = std::max(double(stroke.radius) * std::sqrt(across * down), .75);
    lines.push_back(line);
  }
  return lines;
}

/// What of a downloaded mask is at a pixel.
struct MaskPixel {
  int stroke;
  double weight;
};
inline MaskPixel mask_at(const Pixels& mask, Extent extent, uint32_t x, uint32_t y) {
  const double pixel = double(mask[4 * (size_t{y} * pack4_count(extent.width) + x / 4) + x % 4]);
  return {int(pixel) - 1, 2 * (pixel - std::floor(pixel))};
}

}  // namespace inverse::testing
