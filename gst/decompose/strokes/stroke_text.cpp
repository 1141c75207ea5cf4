// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_text.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "gst/base/color.hpp"
#include "gst/base/json/json_list.hpp"

namespace inverse {
namespace {

using namespace json_list;

constexpr float kMaxRadius = 1e4F;  // pixels
constexpr float kMaxMeters = 1e4F, kMinBall = 1e-3F,
                kMaxBall = 100;  // of a ball's place, its radius
constexpr int kBallDigits = 4;

/// By Stroke::Kind.
struct Kind {
  const char* name;
  Stroke::Kind kind;
};
constexpr std::array<Kind, 4> kKinds{{{"shading", Stroke::Kind::shading},
                                      {"reflectance", Stroke::Kind::reflectance},
                                      {"recolor", Stroke::Kind::recolor},
                                      {"select", Stroke::Kind::select}}};
const char* const kWrongKind =
    " must have the kind \"shading\", \"reflectance\", \"recolor\" or \"select\"";

std::vector<std::array<float, 4>> balls_of(const Json& json, const std::string& name) {
  if (!json.is_array() || json.empty() || json.size() > kMaxPoints)
    refuse("the balls of " + name + " must be a list of at most " + std::to_string(kMaxPoints) +
           ", [[x, y, z, radius], ...], in meters");
  std::vector<std::array<float, 4>> balls;
  for (const Json& ball : json) {
    if (!ball.is_array() || ball.size() != 4)
      refuse("the balls of " + name + " must be like this: [[x, y, z, radius], ...], in meters");
    const auto place = [&](size_t axis) {
      return number_of(ball[axis], -kMaxMeters, kMaxMeters, "the place of a ball of " + name);
    };
    balls.push_back({place(0), place(1), place(2),
                     number_of(ball[3], kMinBall, kMaxBall, "the radius of a ball of " + name)});
  }
  return balls;
}

OrderedJson balls_json(const std::vector<std::array<float, 4>>& balls) {
  OrderedJson json = OrderedJson::array();
  for (const auto& ball : balls) {
    OrderedJson& entry = json.emplace_back(OrderedJson::array());
    for (const float number : ball) entry.push_back(rounded(number, kBallDigits));
  }
  return json;
}

Stroke stroke_of(const Json& json, const std::string& name) {
  if (!json.is_object()) refuse(name + " must be an object with kind, radius and points");
  Stroke stroke;
  bool has_kind = false, has_color = false, has_radius = false;
  for (const auto& [key, value] : json.items()) {
    if (key == "kind") {
      has_kind = true;
      const auto kind =
          std::find_if(kKinds.begin(), kKinds.end(),
                       [&value = value](const Kind& known) { return value == known.name; });
      if (kind == kKinds.end()) refuse(name + kWrongKind);
      stroke.kind = kind->kind;
    } else if (key == "color") {
      has_color = true;
      stroke.color = linear_color(color_of(value, name));
    } else if (key == "radius") {
      has_radius = true;
      stroke.radius = number_of(value, 0.1F, kMaxRadius, "the radius of " + name);
    } else if (key == "fill") {
      if (!value.is_boolean()) refuse("fill of " + name + " must be true or false");
      stroke.fill = value.get<bool>();
    } else if (key == "points") {
      stroke.points = points_of(value, name);
    } else if (key == "balls") {
      stroke.balls = balls_of(value, name);
    } else {
      refuse(name + " has the field \"" + key.substr(0, 40) +
             "\", but only kind, color, radius, fill, points and balls are known");
    }
  }
  if (!has_kind) refuse(name + kWrongKind);
  if (has_color != (stroke.kind == Stroke::Kind::recolor))
    refuse(name + (has_color ? " must have no color: only those of kind \"recolor\" have one"
                             : " recolors and must have a color, \"#rrggbb\""));
  if (stroke.points.empty() && !stroke.in_scene()) refuse(name + " must have points");
  if (stroke.in_scene() && (has_radius || !stroke.points.empty()))
    refuse(name + " lies in the scene by its balls; leave out points and radius");
  return stroke;
}

}  // namespace

StrokeList read_strokes(const std::string& text) {
  StrokeList list;
  for (const Json& stroke : entries_of(text, "strokes", kMaxStrokes, stroke_limit(), list.frame))
    list.strokes.push_back(stroke_of(stroke, "stroke " + std::to_string(list.strokes.size() + 1)));
  return list;
}

Stroke read_stroke(const std::string& text) {
  return stroke_of(parsed(text, stroke_limit()), "the stroke");
}

std::string text_of(const StrokeList& list) {
  OrderedJson strokes = OrderedJson::array();
  for (const Stroke& stroke : list.strokes) {
    OrderedJson entry{{"kind", kKinds[static_cast<size_t>(stroke.kind)].name}};
    if (stroke.kind == Stroke::Kind::recolor) entry["color"] = color_text(srgb_color(stroke.color));
    if (!stroke.in_scene()) entry["radius"] = rounded(stroke.radius, 1);
    if (stroke.fill) entry["fill"] = true;
    if (stroke.in_scene())
      entry["balls"] = balls_json(stroke.balls);
    else
      entry["points"] = points_json(stroke.points);
    strokes.push_back(std::move(entry));
  }
  return json_list::text_of(std::move(strokes), "strokes", list.frame);
}

}  // namespace inverse
