// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stroke_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "common/error.hpp"
#include "common/json.hpp"
#include "gst/base/color.hpp"

namespace inverse {
namespace {

using Json = nlohmann::json;

constexpr float kMaxCoordinate = 1e6F, kMaxRadius = 1e4F;

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorKind::unsupported, what); }

Json parsed(const std::string& text) {
  std::string fault;
  Json json = parse_json<Json>(text, fault);
  if (json.is_discarded()) refuse(fault);
  return json;
}

float number_of(const Json& json, float low, float high, const std::string& name) {
  const double value = json.is_number() ? json.get<double>() : NAN;
  if (!(value >= static_cast<double>(low) && value <= static_cast<double>(high)))
    refuse(name + " must be a number from " + std::to_string(low) + " to " + std::to_string(high));
  return static_cast<float>(value);
}

/// By Stroke::Kind.
struct Kind {
  const char* name;
  Stroke::Kind kind;
};
constexpr std::array<Kind, 3> kKinds{{{"shading", Stroke::Kind::shading},
                                      {"reflectance", Stroke::Kind::reflectance},
                                      {"recolor", Stroke::Kind::recolor}}};
const char* const kWrongKind = " must have the kind \"shading\", \"reflectance\" or \"recolor\"";

std::array<float, 3> color_of(const Json& json, const std::string& name) {
  const std::string text = json.is_string() ? json.get<std::string>() : "";
  uint32_t rgb = 0;
  const char* const end = text.data() + text.size();
  if (text.size() != 7 || text[0] != '#' ||
      std::from_chars(text.data() + 1, end, rgb, 16).ptr != end)
    refuse("the color of " + name + " must be \"#rrggbb\", sRGB in hexadecimal");
  return linear_color(rgb);
}

Stroke stroke_of(const Json& json, const std::string& name) {
  if (!json.is_object()) refuse(name + " must be an object with kind, radius and points");
  Stroke stroke;
  bool has_kind = false, has_color = false;
  for (const auto& [key, value] : json.items()) {
    if (key == "kind") {
      has_kind = true;
      const auto kind = std::find_if(kKinds.begin(), kKinds.end(),
                                     [&](const Kind& known) { return value == known.name; });
      if (kind == kKinds.end()) refuse(name + kWrongKind);
      stroke.kind = kind->kind;
    } else if (key == "color") {
      has_color = true;
      stroke.color = color_of(value, name);
    } else if (key == "radius") {
      stroke.radius = number_of(value, 0.1F, kMaxRadius, "the radius of " + name);
    } else if (key == "fill") {
      if (!value.is_boolean()) refuse("fill of " + name + " must be true or false");
      stroke.fill = value.get<bool>();
    } else if (key == "points") {
      if (!value.is_array() || value.size() > kMaxStrokePoints)
        refuse("the points of " + name + " must be a list of at most " +
               std::to_string(kMaxStrokePoints));
      for (const Json& point : value) {
        if (!point.is_array() || point.size() != 2)
          refuse("the points of " + name + " must be pairs, [[x, y], ...]");
        stroke.points.push_back(
            {number_of(point[0], -kMaxCoordinate, kMaxCoordinate, "x of a point of " + name),
             number_of(point[1], -kMaxCoordinate, kMaxCoordinate, "y of a point of " + name)});
      }
    } else {
      refuse(name + " has the field \"" + key.substr(0, 40) +
             "\", but only kind, color, radius, fill and points are known");
    }
  }
  if (!has_kind) refuse(name + kWrongKind);
  if (has_color != (stroke.kind == Stroke::Kind::recolor))
    refuse(name + (has_color ? " must have no color: only those of kind \"recolor\" have one"
                             : " recolors and must have a color, \"#rrggbb\""));
  if (stroke.points.empty()) refuse(name + " must have points");
  return stroke;
}

std::string text_of(const std::array<float, 3>& color) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%06x", srgb_color(color) & 0xffffffU);
  return text.data();
}

double tenth(float value) { return std::round(static_cast<double>(value) * 10) / 10; }

}  // namespace

StrokeList read_strokes(const std::string& text) {
  StrokeList list;
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) return list;
  const Json json = parsed(text);
  const Json* strokes = &json;
  if (json.is_object()) {
    if (!json.contains("strokes") || !json.contains("frame") || json.size() != 2)
      refuse("must be a list of strokes, or an object with \"frame\" and \"strokes\"");
    const Json& frame = json["frame"];
    if (!frame.is_array() || frame.size() != 2) refuse("\"frame\" must be [width, height]");
    list.frame = {static_cast<uint32_t>(number_of(frame[0], 1, kMaxCoordinate, "the width")),
                  static_cast<uint32_t>(number_of(frame[1], 1, kMaxCoordinate, "the height"))};
    strokes = &json["strokes"];
  }
  if (!strokes->is_array()) refuse("must be a list of strokes");
  if (strokes->size() > kMaxStrokes)
    refuse("has " + std::to_string(strokes->size()) + " strokes; at most " +
           std::to_string(kMaxStrokes) + " are possible");
  for (const Json& stroke : *strokes)
    list.strokes.push_back(stroke_of(stroke, "stroke " + std::to_string(list.strokes.size() + 1)));
  return list;
}

Stroke read_stroke(const std::string& text) { return stroke_of(parsed(text), "the stroke"); }

std::string text_of(const StrokeList& list) {
  if (list.strokes.empty()) return "";
  nlohmann::ordered_json strokes = nlohmann::ordered_json::array();
  for (const Stroke& stroke : list.strokes) {
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    for (const Stroke::Point& point : stroke.points)
      points.push_back({tenth(point[0]), tenth(point[1])});
    nlohmann::ordered_json entry{{"kind", kKinds[static_cast<size_t>(stroke.kind)].name}};
    if (stroke.kind == Stroke::Kind::recolor) entry["color"] = text_of(stroke.color);
    entry["radius"] = tenth(stroke.radius);
    if (stroke.fill) entry["fill"] = true;
    entry["points"] = std::move(points);
    strokes.push_back(std::move(entry));
  }
  if (list.frame.pixels() == 0) return strokes.dump();
  return nlohmann::ordered_json{{"frame", {list.frame.width, list.frame.height}},
                                {"strokes", std::move(strokes)}}
      .dump();
}

}  // namespace inverse
