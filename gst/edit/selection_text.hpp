// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>
#include <vector>

#include "kernels/edit/selection/object/seeds.hpp"

namespace inverse {

inline constexpr size_t kMaxSelectionStrokes = 64;

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
/// A single stroke, as one of such a list.
SelectionStroke read_selection_stroke(const std::string& text);
/// The text that `read_selection` takes, with points rounded to a tenth of a pixel.
std::string text_of(const SelectionList& list);
}  // namespace inverse
