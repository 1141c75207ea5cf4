// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_mask.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/image/pack4.hpp"

namespace inverse {
namespace {

constexpr float kMinRadius = 0.75F;  // pixels of the picture: thinner lines would miss pixels
constexpr float kMaxRadius = 1e5F;

/// Squared distance of a point from the line between two others.
float squared_distance(Stroke::Point p, Stroke::Point from, Stroke::Point to) {
  const float dx = to[0] - from[0], dy = to[1] - from[1], length = dx * dx + dy * dy;
  const float along =
      length > 0 ? std::clamp(((p[0] - from[0]) * dx + (p[1] - from[1]) * dy) / length, 0.0F, 1.0F)
                 : 0;
  const float x = p[0] - from[0] - along * dx, y = p[1] - from[1] - along * dy;
  return x * x + y * y;
}

/// The pixels whose centers lie within `from` … `to`: the first one and the one after the last;
/// none if one of the two is NaN.
std::array<uint32_t, 2> pixels_between(float from, float to, uint32_t size) {
  if (!(from <= to)) return {0, 0};
  const auto clamped = [&](float at) {
    return static_cast<uint32_t>(std::clamp(at, 0.0F, static_cast<float>(size)));
  };
  return {clamped(std::ceil(from - 0.5F)), clamped(std::floor(to - 0.5F) + 1)};
}

}  // namespace

bool covers(const Stroke& stroke, Stroke::Point point) {
  for (size_t i = 0; i < stroke.points.size(); ++i)
    if (squared_distance(point, stroke.points[i > 0 ? i - 1 : 0], stroke.points[i]) <
        stroke.radius * stroke.radius)
      return true;
  return false;
}

StrokeMask draw_strokes(const StrokeList& list, Extent extent) {
  const size_t pitch = size_t{4} * pack4_count(extent.width);
  StrokeMask mask{std::vector<float>(pitch * extent.height), {}};
  const float across = static_cast<float>(extent.width) / static_cast<float>(list.frame.width),
              down = static_cast<float>(extent.height) / static_cast<float>(list.frame.height);
  for (size_t k = 0; k < std::min(list.strokes.size(), kMaxStrokes); ++k) {
    const Stroke& stroke = list.strokes[k];
    const float radius =
        std::clamp(stroke.radius * std::sqrt(across * down), kMinRadius, kMaxRadius);
    const float border = std::min(radius, std::max(radius / 4, 2.0F));
    const auto number = static_cast<float>(k + 1);
    const auto scaled = [&](Stroke::Point p) { return Stroke::Point{p[0] * across, p[1] * down}; };
    StrokeMask::Bounds bounds{UINT32_MAX, UINT32_MAX, 0, 0};
    for (size_t i = 0; i < stroke.points.size(); ++i) {
      const Stroke::Point from = scaled(stroke.points[i > 0 ? i - 1 : 0]),
                          to = scaled(stroke.points[i]);
      const auto [left, right] = pixels_between(std::min(from[0], to[0]) - radius,
                                                std::max(from[0], to[0]) + radius, extent.width);
      const auto [top, bottom] = pixels_between(std::min(from[1], to[1]) - radius,
                                                std::max(from[1], to[1]) + radius, extent.height);
      for (uint32_t y = top; y < bottom; ++y)
        for (uint32_t x = left; x < right; ++x) {
          const Stroke::Point center{static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F};
          const float squared = squared_distance(center, from, to);
          if (!(squared < radius * radius)) continue;
          const float part = std::min((radius - std::sqrt(squared)) / border, 1.0F),
                      weight = part * part;
          float& pixel = mask.pixels[y * pitch + x];
          if (!(weight > 0) || weight < 2 * (pixel - std::floor(pixel))) continue;
          pixel = number + weight / 2;
          bounds = {std::min(bounds.left, x / 4), std::min(bounds.top, y / 4),
                    std::max(bounds.right, x / 4 + 1), std::max(bounds.bottom, y / 4 + 1)};
        }
    }
    mask.bounds.push_back(bounds.right > 0 ? bounds : StrokeMask::Bounds{});
  }
  return mask;
}

}  // namespace inverse
