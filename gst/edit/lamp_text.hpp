// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <string>

#include "kernels/edit/relight/lamps.hpp"

namespace inverse {

/// Reads lamps from JSON: a list of
///
///     {"kind": "point" | "spot" | "directional", "position": [x, y, z], "direction": [x, y, z],
///      "color": "#rrggbb", "power": 0.1, "angle": 30, "softness": 0.3, "radius": 0.02}
///
/// with positions in pixels of the frame, or {"frame": [width, height], "lamps": [...]} in pixels
/// of a frame of that size (Lamp). Point and spot need a position, directional a direction. Empty
/// text is no lamp. The frame of the result is empty if the text has none. Throws
/// Error(unsupported) that says what is wrong and where.
LampList read_lamps(const std::string& text);

/// A single lamp, as one of such a list.
Lamp read_lamp(const std::string& text);

/// The text that `read_lamps` takes, with pixels rounded to tenths; empty for no lamps.
std::string text_of(const LampList& list);

}  // namespace inverse
