// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "kernels/image/strokes/stroke.hpp"

namespace inverse {

/// Reads strokes from JSON: a list of
///
///     {"kind": "shading" | "reflectance" | "recolor" | "select", "color": "#rrggbb", "radius": 8,
///     "fill": false,
///      "points": [[x, y], ...]}
///
/// ("color": sRGB, of "recolor" alone) in pixels of the frame; with "balls": [[x, y, z, radius],
/// ...] in place of points and radius, in meters of the remembered scene; or {"frame": [width,
/// height], "strokes": [...]} in pixels of a frame of that size. Empty text is no stroke. The frame
/// of the result is empty if the text has none. Throws Error(unsupported) that says what is wrong
/// and where.
StrokeList read_strokes(const std::string& text);

/// A single stroke, as one of such a list.
Stroke read_stroke(const std::string& text);

/// The text that `read_strokes` takes, with points rounded to a tenth of a pixel; empty for no
/// strokes.
std::string text_of(const StrokeList& list);

}  // namespace inverse
