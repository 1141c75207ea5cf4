// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_text.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "gst/base/color.hpp"
#include "gst/base/json/json_list.hpp"

namespace inverse {
namespace {

using namespace json_list;

constexpr float kMinRadius = 0.1F, kMaxRadius = 1e4F;  // pixels
constexpr float kMinBall = 0.001F, kMaxBall = 100;     // meters

/// By Stroke::Kind.
struct Kind {
  const char* name;
  Stroke::Kind kind;
};
constexpr std::array<Kind, 3> kKinds{{{"shading", Stroke::Kind::shading},
                                      {"reflectance", Stroke::Kind::reflectance},
                                      {"recolor", Stroke::Kind::recolor}}};
const char* const kWrongKind = " must have the kind \"shading\", \"reflectance\" or \"recolor\"";

Stroke stroke_of(const Json& json, const std::string& name) {
  if (!json.is_object()) refuse(name + " must be an object with kind, radius and points");
  Stroke stroke;
  bool has_kind = false, has_color = false;
  const Json* radius = nullptr;
  for (const auto& [key, value] : json.items()) {
    if (key == "kind") {
      has_kind = true;
      const auto kind = std::find_if(kKinds.begin(), kKinds.end(),
                                     [&](const Kind& known) { return value == known.name; });
      if (kind == kKinds.end()) refuse(name + kWrongKind);
      stroke.kind = kind->kind;
    } else if (key == "color") {
      has_color = true;
      stroke.color = linear_color(color_of(value, name));
    } else if (key == "radius") {
      radius = &value;
    } else if (key == "fill") {
      if (!value.is_boolean()) refuse("fill of " + name + " must be true or false");
      stroke.fill = value.get<bool>();
    } else if (key == "points") {
      const bool in_scene =
          value.is_array() && !value.empty() && value[0].is_array() && value[0].size() == 3;
      if (in_scene)
        stroke.places = places_of(value, name);
      else
        stroke.points = points_of(value, name);
    } else {
      refuse(name + " has the field \"" + key.substr(0, 40) +
             "\", but only kind, color, radius, fill and points are known");
    }
  }
  if (!has_kind) refuse(name + kWrongKind);
  if (has_color != (stroke.kind == Stroke::Kind::recolor))
    refuse(name + (has_color ? " must have no color: only those of kind \"recolor\" have one"
                             : " recolors and must have a color, \"#rrggbb\""));
  if (stroke.points.empty() && !stroke.in_scene()) refuse(name + " must have points");
  if (radius)
    stroke.radius = stroke.in_scene()
                        ? number_of(*radius, kMinBall, kMaxBall, "the radius in meters of " + name)
                        : number_of(*radius, kMinRadius, kMaxRadius, "the radius of " + name);
  else if (stroke.in_scene())
    refuse(name + " lies in the scene and must have a radius, in meters");
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
    entry["radius"] = rounded(stroke.radius, stroke.in_scene() ? kMeterDigits : 1);
    if (stroke.fill) entry["fill"] = true;
    entry["points"] = stroke.in_scene() ? places_json(stroke.places) : points_json(stroke.points);
    strokes.push_back(std::move(entry));
  }
  return json_list::text_of(std::move(strokes), "strokes", list.frame);
}

}  // namespace inverse
