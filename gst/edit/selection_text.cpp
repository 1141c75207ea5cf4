// SPDX-License-Identifier: LGPL-2.1-or-later
#include "selection_text.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "gst/base/json/json_list.hpp"

namespace inverse {
namespace {

using namespace json_list;

constexpr float kMaxRadius = 1e4F;

SelectionStroke stroke_of(const Json& json, const std::string& name) {
  if (!json.is_object()) refuse(name + " must be an object with kind and points");
  SelectionStroke stroke;
  for (const auto& [key, value] : json.items()) {
    if (key == "kind" && (value == "add" || value == "subtract")) {
      stroke.subtract = value == "subtract";
    } else if (key == "kind") {
      refuse(name + " must have the kind \"add\" or \"subtract\"");
    } else if (key == "radius") {
      stroke.radius = number_of(value, .1F, kMaxRadius, "the radius of " + name);
    } else if (key == "closed") {
      if (!value.is_boolean()) refuse("closed of " + name + " must be true or false");
      stroke.closed = value.get<bool>();
    } else if (key == "points") {
      stroke.points = points_of(value, name);
    } else {
      refuse(name + " has the field \"" + key.substr(0, 40) +
             "\", but only kind, radius, closed and points are known");
    }
  }
  if (!json.contains("kind")) refuse(name + " must have the kind \"add\" or \"subtract\"");
  if (stroke.points.empty()) refuse(name + " must have points");
  return stroke;
}

}  // namespace

bool SelectionList::begins_with(const SelectionList& list) const {
  return list.frame == frame && list.strokes.size() <= strokes.size() &&
         std::equal(list.strokes.begin(), list.strokes.end(), strokes.begin());
}

SelectionStroke read_selection_stroke(const std::string& text) {
  return stroke_of(parsed(text, stroke_limit()), "the stroke");
}

SelectionList read_selection(const std::string& text) {
  SelectionList list;
  for (const Json& stroke :
       entries_of(text, "strokes", kMaxSelectionStrokes, stroke_limit(), list.frame))
    list.strokes.push_back(stroke_of(stroke, "stroke " + std::to_string(list.strokes.size() + 1)));
  return list;
}

std::string text_of(const SelectionList& list) {
  OrderedJson strokes = OrderedJson::array();
  for (const SelectionStroke& stroke : list.strokes) {
    OrderedJson entry{{"kind", stroke.subtract ? "subtract" : "add"},
                      {"radius", rounded(stroke.radius, 1)}};
    if (stroke.closed) entry["closed"] = true;
    entry["points"] = points_json(stroke.points);
    strokes.push_back(std::move(entry));
  }
  return json_list::text_of(std::move(strokes), "strokes", list.frame);
}

}  // namespace inverse
