// SPDX-License-Identifier: LGPL-2.1-or-later
#include "selection_strokes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/error.hpp"
#include "common/json.hpp"

namespace inverse {
namespace {

using Json = nlohmann::json;

constexpr size_t kMaxStrokes = 64, kMaxPoints = 4096, kMaxUndo = 100;
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
      if (!value.is_array() || value.size() > kMaxPoints)
        refuse("the points of " + name + " must be a list of at most " +
               std::to_string(kMaxPoints));
      for (const Json& point : value) {
        if (!point.is_array() || point.size() != 2)
          refuse("the points of " + name + " must be pairs, [[x, y], ...]");
        stroke.points.push_back(
            {number_of(point[0], -kMaxCoordinate, kMaxCoordinate, "x of a point of " + name),
             number_of(point[1], -kMaxCoordinate, kMaxCoordinate, "y of a point of " + name)});
      }
    } else {
      refuse(name + " has the field \"" + key.substr(0, 40) +
             "\", but only kind, radius, closed and points are known");
    }
  }
  if (!json.contains("kind")) refuse(name + " must have the kind \"add\" or \"subtract\"");
  if (stroke.points.empty()) refuse(name + " must have points");
  return stroke;
}

double tenth(float value) { return std::round(static_cast<double>(value) * 10) / 10; }

/// The property as it is now.
std::string property_of(const Log& log) {
  gchar* text = nullptr;
  g_object_get(log.object, "strokes", &text, nullptr);
  std::string result = text ? text : "";
  g_free(text);
  return result;
}

}  // namespace

bool SelectionList::begins_with(const SelectionList& list) const {
  return list.frame == frame && list.strokes.size() <= strokes.size() &&
         std::equal(list.strokes.begin(), list.strokes.end(), strokes.begin());
}

SelectionList read_selection(const std::string& text) {
  SelectionList list;
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

std::string text_of(const SelectionList& list) {
  if (list.strokes.empty()) return "";
  nlohmann::ordered_json strokes = nlohmann::ordered_json::array();
  for (const SelectionStroke& stroke : list.strokes) {
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    for (const auto& point : stroke.points) points.push_back({tenth(point[0]), tenth(point[1])});
    nlohmann::ordered_json entry{{"kind", stroke.subtract ? "subtract" : "add"},
                                 {"radius", tenth(stroke.radius)}};
    if (stroke.closed) entry["closed"] = true;
    entry["points"] = std::move(points);
    strokes.push_back(std::move(entry));
  }
  if (list.frame.pixels() == 0) return strokes.dump();
  return nlohmann::ordered_json{{"frame", {list.frame.width, list.frame.height}},
                                {"strokes", std::move(strokes)}}
      .dump();
}

std::string wrong_selection(const GValue* value) {
  const char* text = g_value_get_string(value);
  try {
    read_selection(text ? text : "");
    return {};
  } catch (const Error& error) {
    return std::string("strokes ") + error.what();
  }
}

void SelectionEditor::resize(Extent frame) {
  const std::lock_guard lock(mutex_);
  frame_ = frame;
}

void SelectionEditor::flush() {
  const std::lock_guard lock(mutex_);
  drawing_.reset();
}

void SelectionEditor::set(const Log& log, const SelectionList& list) {
  {
    std::string before = property_of(log);
    const std::lock_guard lock(mutex_);
    undo_.push_back(std::move(before));
    if (undo_.size() > kMaxUndo) undo_.erase(undo_.begin());
  }
  g_object_set(log.object, "strokes", text_of(list).c_str(), nullptr);
}

void SelectionEditor::mouse(const Log& log, const MouseEvent& event, SelectMode mode,
                            float radius) {
  using Kind = MouseEvent::Kind;
  std::optional<SelectionStroke> finished;
  Extent frame;
  {
    const std::lock_guard lock(mutex_);
    if (frame_.pixels() == 0 || !std::isfinite(event.x) || !std::isfinite(event.y)) return;
    const auto at = [](double value) {
      return static_cast<float>(
          std::clamp(value, -static_cast<double>(kMaxCoordinate), double{kMaxCoordinate}));
    };
    const SelectionStroke::Point point{at(event.x), at(event.y)};
    if (event.kind == Kind::press && mode != SelectMode::off)
      drawing_ =
          SelectionStroke{mode == SelectMode::subtract, mode == SelectMode::lasso, {point}, radius};
    else if (drawing_ && drawing_->points.size() < kMaxPoints &&
             std::hypot(point[0] - drawing_->points.back()[0],
                        point[1] - drawing_->points.back()[1]) >= std::max(radius / 4, 1.F))
      drawing_->points.push_back(point);
    if (event.kind == Kind::release) finished = std::exchange(drawing_, std::nullopt);
    frame = frame_;
  }
  if (!finished) return;
  SelectionList list = read_selection(property_of(log));
  if (list.strokes.size() == kMaxStrokes) list.strokes.erase(list.strokes.begin());
  if (list.frame.pixels() > 0)
    for (auto& point : finished->points)
      point = {point[0] * static_cast<float>(list.frame.width) / static_cast<float>(frame.width),
               point[1] * static_cast<float>(list.frame.height) / static_cast<float>(frame.height)};
  list.strokes.push_back(std::move(*finished));
  set(log, list);
}

void SelectionEditor::add(const Log& log, const std::string& stroke) {
  SelectionList list = read_selection(property_of(log));
  if (list.strokes.size() == kMaxStrokes)
    refuse("there are " + std::to_string(kMaxStrokes) + " strokes already; clear them first");
  list.strokes.push_back(stroke_of(parsed(stroke), "the stroke"));
  set(log, list);
}

void SelectionEditor::clear(const Log& log) { set(log, {}); }

void SelectionEditor::undo(const Log& log) {
  std::string before;
  {
    const std::lock_guard lock(mutex_);
    if (undo_.empty()) refuse("no change of strokes is left to undo");
    before = std::move(undo_.back());
    undo_.pop_back();
  }
  g_object_set(log.object, "strokes", before.c_str(), nullptr);
}

}  // namespace inverse
