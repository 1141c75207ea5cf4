// SPDX-License-Identifier: LGPL-2.1-or-later
#include "selection_strokes.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

namespace inverse {
namespace {

using namespace json_list;

constexpr size_t kMaxStrokes = 64;
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

SelectionList read_selection(const std::string& text) {
  SelectionList list;
  for (const Json& stroke : entries_of(text, "strokes", kMaxStrokes, stroke_limit(), list.frame))
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

std::vector<std::string> warnings_of(const SelectionList& list, std::span<const SeedCells> cells,
                                     Extent frame) {
  const size_t first = list.strokes.size() - cells.size();
  std::vector<size_t> outside, under;
  for (size_t i = 0; i < cells.size(); ++i)
    if (cells[i].covered == 0)
      outside.push_back(first + i);
    else if (cells[i].taken == cells[i].covered)
      under.push_back(first + i);
  std::vector<std::string> warnings{outside_of(outside, frame),
                                    under_others(under, "add, subtract")};
  if (std::all_of(list.strokes.begin(), list.strokes.end(),
                  [](const SelectionStroke& stroke) { return stroke.subtract; }))
    warnings.push_back(
        "stroke 1: nothing is selected that it could subtract from; draw a stroke of "
        "kind add on the object first");
  std::erase(warnings, "");
  return warnings;
}

std::string wrong_selection(const GValue* value) {
  return wrong_text(value, "strokes", read_selection);
}

void SelectionEditor::resize(Extent frame) {
  const Lock lock(mutex_);
  frame_ = frame;
}

void SelectionEditor::flush() {
  const Lock lock(mutex_);
  drawing_.reset();
}

void SelectionEditor::mouse(const Log& log, const MouseEvent& event, SelectMode mode,
                            float radius) {
  using Kind = MouseEvent::Kind;
  const auto point = mouse_place(event);
  if (!point) return;
  std::optional<SelectionStroke> finished;
  Extent frame;
  {
    const Lock lock(mutex_);
    if (frame_.pixels() == 0) return;
    if (event.kind == Kind::press && mode != SelectMode::off)
      drawing_ = SelectionStroke{
          mode == SelectMode::subtract, mode == SelectMode::lasso, {*point}, radius};
    else if (drawing_)
      extend(drawing_->points, *point, radius);
    if (event.kind == Kind::release) finished = std::exchange(drawing_, std::nullopt);
    frame = frame_;
  }
  if (!finished) return;
  change(log, [&](const std::string& text) -> std::optional<std::string> {
    SelectionList list = read_selection(text);
    if (list.strokes.size() == kMaxStrokes) {
      const Lock lock(mutex_);
      warnings_.push_back(full(kMaxStrokes) + "; remove one to draw another");
      return {};
    }
    list.strokes.push_back(*finished);
    scale(list.strokes.back().points, frame, list.frame);
    return text_of(list);
  });
}

void SelectionEditor::add(const Log& log, const std::string& stroke) {
  change(log, [&](const std::string& text) {
    SelectionList list = read_selection(text);
    if (list.strokes.size() == kMaxStrokes)
      refuse(full(kMaxStrokes) + "; remove one to add another");
    list.strokes.push_back(stroke_of(parsed(stroke, stroke_limit()), "the stroke"));
    return text_of(list);
  });
}

void SelectionEditor::remove(const Log& log, unsigned index) {
  change(log, [&](const std::string& text) {
    SelectionList list = read_selection(text);
    erase(list.strokes, index);
    return text_of(list);
  });
}

}  // namespace inverse
