// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gst/base/json/list_editor.hpp"
#include "selection_text.hpp"

namespace inverse {

/// Warnings about strokes without effect. `cells` are those of the last strokes of the list, which
/// were drawn on a frame of the size `frame`.
std::vector<std::string> warnings_of(const SelectionList& list, std::span<const SeedCells> cells,
                                     Extent frame);
/// What is wrong with a value of the property `strokes`, in words.
std::string wrong_selection(const GValue* value);

/// What the mouse draws.
enum class SelectMode : uint8_t { off, add, subtract, lasso };

/// Draws the strokes of the property `strokes` with the mouse.
class SelectionEditor : public ListEditor {
 public:
  SelectionEditor() : ListEditor("stroke", "strokes::list") {}
  void mouse(const Log& log, const MouseEvent& event, SelectMode mode, float radius);
  /// What the action signals do; throw Error(unsupported).
  void add(const Log& log, const std::string& stroke);
  void remove(const Log& log, unsigned index);  ///< from 1 on
  /// Frames have this size from now on.
  void resize(Extent frame);
  /// Forgets the stroke that is being drawn: its picture is gone.
  void flush();

 private:
  std::optional<SelectionStroke> drawing_;
};

}  // namespace inverse
