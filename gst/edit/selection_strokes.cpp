// SPDX-License-Identifier: LGPL-2.1-or-later
#include "selection_strokes.hpp"

#include <algorithm>
#include <utility>

namespace inverse {

using namespace json_list;

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
  return wrong_text(value, "strokes::list", read_selection);
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
    if (list.strokes.size() == kMaxSelectionStrokes) {
      const Lock lock(mutex_);
      warnings_.push_back(full(kMaxSelectionStrokes) + "; remove one to draw another");
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
    if (list.strokes.size() == kMaxSelectionStrokes)
      refuse(full(kMaxSelectionStrokes) + "; remove one to add another");
    list.strokes.push_back(read_selection_stroke(stroke));
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
