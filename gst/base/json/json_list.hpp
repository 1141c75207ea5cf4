// SPDX-License-Identifier: LGPL-2.1-or-later
// Properties that are lists in JSON, of things that a user draws on the picture: strokes, lamps.
#pragma once
#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "kernels/image/plane.hpp"

namespace inverse::json_list {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

/// Pixels that a coordinate may be away from the frame's corner.
inline constexpr float kMaxCoordinate = 1e6F;
/// Points that a line may have.
inline constexpr size_t kMaxPoints = 4096;

/// Throws Error(unsupported).
[[noreturn]] void refuse(const std::string& what);
/// The value that a text is. Throws Error(unsupported) if it is no JSON; `limit` is what it may
/// have, in words.
Json parsed(const std::string& text, const std::string& limit);

// What follows throws Error(unsupported) that names the value.
float number_of(const Json& json, float low, float high, const std::string& name);
/// 0xRRGGBB of "#rrggbb".
uint32_t color_of(const Json& json, const std::string& name);
/// Of [[x, y], ...] the points, at most kMaxPoints; `name` is of what they belong to.
std::vector<std::array<float, 2>> points_of(const Json& json, const std::string& name);

/// What `points_of` reads, rounded to a tenth of a pixel.
OrderedJson points_json(const std::vector<std::array<float, 2>>& points);

/// The entries of a text, of at most `max`: a list of them, or {"frame": [width, height], NAME:
/// [...]}. Empty text has none. `what` is what they are called, `limit` what each may have, in
/// words. `frame` is empty if the text has none.
std::vector<Json> entries_of(const std::string& text, const std::string& what, size_t max,
                             const std::string& limit, Extent& frame);
/// The text that `entries_of` takes; empty for no entries.
std::string text_of(OrderedJson entries, const std::string& what, Extent frame);
/// "#rrggbb"; alpha is ignored.
std::string color_text(uint32_t argb);
/// Rounded to so many digits behind the point.
double rounded(float value, int digits);

/// The limit of strokes, in words.
inline std::string stroke_limit() { return std::to_string(kMaxPoints) + " points"; }

}  // namespace inverse::json_list
