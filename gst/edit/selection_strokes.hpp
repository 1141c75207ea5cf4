// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gst/base/json/list_editor.hpp"
#include "kernels/edit/selection/object/seeds.hpp"

namespace inverse {

/// The strokes that an object is selected by, drawn on a frame of one size.
struct SelectionList {
  std::vector<SelectionStroke> strokes;
  Extent frame;  ///< empty: that of the video

  /// Whether these are the strokes of `list`, and perhaps more.
  bool begins_with(const SelectionList& list) const;
};

/// Reads strokes from JSON: a list of
///
///     {"kind": "add" | "subtract", "radius": 6, "closed": false, "points": [[x, y], ...]}
///
/// in pixels of the frame, or {"frame": [width, height], "strokes": [...]} in pixels of a frame of
/// that size. Empty text is no stroke. Throws Error(unsupported) that says what is wrong.
SelectionList read_selection(const std::string& text);
/// The text that `read_selection` takes, with points rounded to a tenth of a pixel.
std::string text_of(const SelectionList& list);
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
  SelectionEditor() : ListEditor("stroke") {}
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
