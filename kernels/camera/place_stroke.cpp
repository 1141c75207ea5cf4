// SPDX-License-Identifier: LGPL-2.1-or-later
#include "place_stroke.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace inverse {
namespace {

/// A point of the frame in pixels of the view, whose centers are at whole numbers.
Stroke::Point in_view(Stroke::Point point, Extent frame, Extent view) {
  const Stroke::Point p = scaled(point, frame, view);
  return {p[0] - 0.5F, p[1] - 0.5F};
}

/// Pixels of the view along one of the frame.
float view_scale(Extent frame, Extent view) {
  return std::sqrt(static_cast<float>(view.pixels()) / static_cast<float>(frame.pixels()));
}

float focal_length(const Lens& lens) { return std::sqrt(std::abs(lens.fx * lens.fy)); }

struct Segment {
  Stroke::Point from, to;
  float length() const { return std::hypot(to[0] - from[0], to[1] - from[1]); }
};

/// The part of a segment that is in the view; nothing if none is.
std::optional<Segment> clipped(const Segment& segment, Extent view) {
  const std::array<float, 2> last{static_cast<float>(view.width) - 0.5F,
                                  static_cast<float>(view.height) - 0.5F};
  float start = 0, end = 1;
  for (size_t axis = 0; axis < 2; ++axis) {
    const float from = segment.from[axis], along = segment.to[axis] - from;
    if (along == 0) {
      if (from < -0.5F || from > last[axis]) return {};
      continue;
    }
    const float a = (-0.5F - from) / along, b = (last[axis] - from) / along;
    start = std::max(start, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (!(start <= end)) return {};
  const auto at = [&](float share) {
    return Stroke::Point{segment.from[0] + share * (segment.to[0] - segment.from[0]),
                         segment.from[1] + share * (segment.to[1] - segment.from[1])};
  };
  return Segment{at(start), at(end)};
}

/// Points of segments, about `step` apart.
std::vector<Stroke::Point> resampled(const std::vector<Segment>& segments, float step) {
  constexpr float kShorter = 0.9F;
  std::vector<Stroke::Point> result;
  for (const auto& [from, to] : segments) {
    const auto parts = std::max(std::ceil(Segment{from, to}.length() / step), 1.0F);
    for (float n = 0; n <= parts; ++n) {
      const Stroke::Point p{from[0] + n / parts * (to[0] - from[0]),
                            from[1] + n / parts * (to[1] - from[1])};
      if (result.empty() || Segment{result.back(), p}.length() > kShorter * step)
        result.push_back(p);
    }
  }
  return result;
}

constexpr float kMaxPlaces = 1024;  // of a stroke, about; longer ones have balls farther apart

}  // namespace

std::optional<Stroke> placed_in_scene(const Stroke& stroke, Extent frame, const SceneView& view) {
  std::vector<Segment> line;
  float length = 0;
  for (size_t i = 0; i < stroke.points.size(); ++i) {
    const auto part = clipped({in_view(stroke.points[i > 0 ? i - 1 : 0], frame, view.extent),
                               in_view(stroke.points[i], frame, view.extent)},
                              view.extent);
    if (!part || (i == 0 && stroke.points.size() > 1)) continue;
    line.push_back(*part);
    length += part->length();
  }
  const float radius = stroke.radius * view_scale(frame, view.extent);
  const float step = std::max({radius / 2, 0.5F, length / kMaxPlaces});
  Stroke placed = stroke;
  placed.points.clear();
  placed.radius = Stroke{}.radius;
  for (const Stroke::Point& p : resampled(line, step)) {
    const auto pixel = [](float at, uint32_t size) {
      return static_cast<size_t>(std::clamp(at + 0.5F, 0.0F, static_cast<float>(size - 1)));
    };
    const float z = view.depth[pixel(p[1], view.extent.height) * view.extent.width +
                               pixel(p[0], view.extent.width)];
    if (!(z > 0)) continue;
    const auto center = to_world(view.pose, {z * (p[0] - view.lens.cx) / view.lens.fx,
                                             z * (p[1] - view.lens.cy) / view.lens.fy, z});
    placed.balls.push_back({center[0], center[1], center[2], radius * z / focal_length(view.lens)});
  }
  if (!placed.in_scene()) return {};
  return placed;
}

float radius_in_scene(float radius, const std::array<float, 3>& place, Extent frame,
                      const SceneView& view) {
  return radius * view_scale(frame, view.extent) * to_camera(view.pose, place)[2] /
         focal_length(view.lens);
}

bool covers(const Stroke& stroke, Stroke::Point point, Extent frame, const SceneView& view) {
  const Stroke::Point at = in_view(point, frame, view.extent);
  return std::ranges::any_of(stroke.balls, [&](const auto& ball) {
    const auto p = to_camera(view.pose, {ball[0], ball[1], ball[2]});
    if (!(p[2] > 0)) return false;
    const auto [x, y] = projected(view.lens, p);
    return std::hypot(at[0] - x, at[1] - y) < ball[3] * focal_length(view.lens) / p[2];
  });
}

}  // namespace inverse
