// SPDX-License-Identifier: LGPL-2.1-or-later
#include <algorithm>
#include <cmath>

#include "stroke.hpp"

namespace inverse {
namespace {

constexpr float kMinRadius = 0.75F;  // pixels of the picture: thinner lines would miss pixels
constexpr float kMaxRadius = 1e5F;
constexpr float kDeepest = 2;
// Pixels along the longer side of find_useless: kFine if strokes are thin.
constexpr uint32_t kCoarse = 512, kFine = 2048;
constexpr float kTexelsOfRadius = 2;

/// A brush on a picture, in its pixels.
struct Brush {
  float across, down;  // pixels of the picture along one of the frame
  float radius, border;
  Brush(const Stroke& stroke, Extent frame, Extent picture)
      : across(static_cast<float>(picture.width) / static_cast<float>(frame.width)),
        down(static_cast<float>(picture.height) / static_cast<float>(frame.height)),
        radius(std::clamp(stroke.radius * std::sqrt(across * down), kMinRadius, kMaxRadius)),
        border(std::min(radius, std::max(radius / 4, 2.0F))) {}
  Stroke::Point scaled(Stroke::Point p) const { return {p[0] * across, p[1] * down}; }
};

/// The texels from `low` on whose centers lie within `from` … `to`: the first one and the one after
/// the last; none if one of the two is NaN.
std::array<int32_t, 2> texels_between(float from, float to, float step, int32_t low, int32_t high) {
  if (!(from <= to)) return {low, low};
  const auto clamped = [&](float at) {
    return static_cast<int32_t>(std::clamp(at, static_cast<float>(low), static_cast<float>(high)));
  };
  return {clamped(std::ceil(from / step - 0.5F)), clamped(std::floor(to / step - 0.5F) + 1)};
}

/// Texels from the first up to the one after the last, along x and y.
struct Box {
  int32_t left, top, right, bottom;
  bool empty() const { return left >= right || top >= bottom; }
  uint64_t area() const {
    return empty() ? 0 : static_cast<uint64_t>(right - left) * static_cast<uint64_t>(bottom - top);
  }
};

Box box_of(Stroke::Point from, Stroke::Point to, float radius, uint32_t step, Extent extent) {
  const float reach = radius + static_cast<float>(step);  // interpolation reads so far
  const auto along = [&](size_t axis, uint32_t size) {
    const auto margin = static_cast<int32_t>(size / 8 / step + 1),
               end = static_cast<int32_t>((size + step - 1) / step);
    return texels_between(std::min(from[axis], to[axis]) - reach,
                          std::max(from[axis], to[axis]) + reach, static_cast<float>(step), -margin,
                          end + margin);
  };
  const auto x = along(0, extent.width), y = along(1, extent.height);
  return {x[0], y[0], x[1], y[1]};
}

Box box_of(const Stroke& stroke, const Brush& brush, uint32_t step, Extent extent) {
  Box all{INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  for (size_t i = 0; i < stroke.points.size(); ++i) {
    const Box box = box_of(brush.scaled(stroke.points[i > 0 ? i - 1 : 0]),
                           brush.scaled(stroke.points[i]), brush.radius, step, extent);
    if (box.empty()) continue;
    all = {std::min(all.left, box.left), std::min(all.top, box.top), std::max(all.right, box.right),
           std::max(all.bottom, box.bottom)};
  }
  return all.empty() ? Box{} : all;
}

void draw(const Stroke& stroke, const Brush& brush, uint32_t step, Extent extent, const Box& box,
          float* depths) {
  const auto width = static_cast<size_t>(box.right - box.left);
  uint64_t shallow = box.area();  // texels that a further segment may change
  for (size_t i = 0; i < stroke.points.size() && shallow > 0; ++i) {
    const Stroke::Point from = brush.scaled(stroke.points[i > 0 ? i - 1 : 0]),
                        to = brush.scaled(stroke.points[i]);
    const Box part = box_of(from, to, brush.radius, step, extent);
    for (int32_t y = part.top; y < part.bottom; ++y)
      for (int32_t x = part.left; x < part.right; ++x) {
        float& depth =
            depths[static_cast<size_t>(y - box.top) * width + static_cast<size_t>(x - box.left)];
        if (depth == kDeepest) continue;
        const auto center = [&](int32_t at) {
          return (static_cast<float>(at) + 0.5F) * static_cast<float>(step);
        };
        const float distance = std::sqrt(squared_distance({center(x), center(y)}, from, to));
        const float here = std::min((brush.radius - distance) / brush.border, kDeepest);
        if (!(here > depth)) continue;
        depth = here;
        shallow -= depth == kDeepest;
      }
  }
}

}  // namespace

bool covers(const Stroke& stroke, Stroke::Point point) {
  return squared_distance(point, stroke.points) < stroke.radius * stroke.radius;
}

StrokePatches draw_patches(const StrokeList& list, Extent extent) {
  StrokePatches result;
  const size_t count = std::min(list.strokes.size(), kMaxStrokes);
  std::vector<Box> boxes;
  for (;; result.step *= 2) {
    uint64_t area = 0;
    boxes.clear();
    for (size_t k = 0; k < count; ++k) {
      boxes.push_back(
          box_of(list.strokes[k], Brush(list.strokes[k], list.frame, extent), result.step, extent));
      area += boxes.back().area();
    }
    if (area <= kMaxCover * std::max<uint64_t>(extent.pixels(), 4096)) break;
  }
  for (size_t k = 0; k < count; ++k) {
    const Box& box = boxes[k];
    const size_t first = (result.depths.size() + StrokePatches::kAlign - 1) /
                         StrokePatches::kAlign * StrokePatches::kAlign;
    result.depths.resize(first + box.area(), -1);
    draw(list.strokes[k], Brush(list.strokes[k], list.frame, extent), result.step, extent, box,
         result.depths.data() + first);
    result.patches.push_back({box.left, box.top, static_cast<uint32_t>(box.right - box.left),
                              static_cast<uint32_t>(box.bottom - box.top),
                              static_cast<uint32_t>(first / StrokePatches::kAlign)});
  }
  if (result.depths.empty()) result.depths.push_back(-1);
  return result;
}

UselessStrokes find_useless(const StrokeList& list) {
  using Kind = Stroke::Kind;
  const uint32_t longer = std::max(list.frame.width, list.frame.height);
  float thinnest = kMaxRadius;
  for (const Stroke& stroke : list.strokes)
    if (!stroke.in_scene()) thinnest = std::min(thinnest, stroke.radius);
  const uint32_t factor =
      std::clamp(static_cast<uint32_t>(std::max(thinnest / kTexelsOfRadius, 0.0F)),
                 longer / kFine + 1, longer / kCoarse + 1);
  const Extent extent{(list.frame.width + factor - 1) / factor,
                      (list.frame.height + factor - 1) / factor};
  const StrokePatches patches = draw_patches(list, extent);
  const auto width = static_cast<int32_t>((extent.width + patches.step - 1) / patches.step),
             height = static_cast<int32_t>((extent.height + patches.step - 1) / patches.step);
  struct Texel {
    float depth = 0;  // 0: no stroke
    uint32_t stroke = 0;
  };
  std::vector<Texel> texels(static_cast<size_t>(width) * static_cast<size_t>(height));
  std::vector<size_t> covered(patches.patches.size()), taken(covered.size());
  for (uint32_t k = 0; k < covered.size(); ++k) {
    const StrokePatches::Patch& patch = patches.patches[k];
    const Kind kind = list.strokes[k].kind;
    const float* depths = patches.depths.data() + size_t{patch.first} * StrokePatches::kAlign;
    const auto right = patch.left + static_cast<int32_t>(patch.width),
               bottom = patch.top + static_cast<int32_t>(patch.height);
    for (int32_t y = std::max(patch.top, 0); y < std::min(bottom, height); ++y)
      for (int32_t x = std::max(patch.left, 0); x < std::min(right, width); ++x) {
        const float depth = std::min(depths[static_cast<size_t>(y - patch.top) * patch.width +
                                            static_cast<size_t>(x - patch.left)],
                                     1.0F);
        if (!(depth > 0)) continue;
        ++covered[k];
        if (kind == Kind::recolor || kind == Kind::select) continue;
        Texel& texel =
            texels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
        const bool other = texel.depth > 0 && list.strokes[texel.stroke].kind != kind;
        if (depth < texel.depth) continue;
        taken[texel.stroke] += other;
        if (other || texel.depth == 0) texel.stroke = k;
        texel.depth = depth;
      }
  }
  UselessStrokes useless;
  for (size_t k = 0; k < covered.size(); ++k)
    if (list.strokes[k].in_scene())
      continue;
    else if (covered[k] == 0)
      useless.outside.push_back(k);
    else if (taken[k] == covered[k])
      useless.under.push_back(k);
  return useless;
}

}  // namespace inverse
