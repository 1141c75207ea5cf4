// SPDX-License-Identifier: LGPL-2.1-or-later
#include "json_list.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/json.hpp"

namespace inverse::json_list {

void refuse(const std::string& what) { throw Error(ErrorKind::unsupported, what); }

Json parsed(const std::string& text, const std::string& limit) {
  std::string fault;
  // A list far beyond kMaxPoints is refused before it takes memory.
  Json json = parse_json<Json>(text, fault, "has more values than " + limit + "; leave out some",
                               16 * kMaxPoints);
  if (json.is_discarded()) refuse("the text " + fault);
  return json;
}

float number_of(const Json& json, float low, float high, const std::string& name) {
  const auto value = static_cast<float>(json.is_number() ? json.get<double>() : NAN);
  if (value >= low && value <= high) return value;
  std::array<char, 80> range{};
  std::snprintf(range.data(), range.size(), " must be a number from %.7g to %.7g",
                static_cast<double>(low), static_cast<double>(high));
  refuse(name + range.data());
}

uint32_t color_of(const Json& json, const std::string& name) {
  const std::string text = json.is_string() ? json.get<std::string>() : "";
  constexpr size_t kLength = 7;
  uint32_t rgb = 0;
  const char* const end = text.data() + text.size();
  if (text.size() != kLength || text[0] != '#' ||
      std::from_chars(text.data() + 1, end, rgb, 16).ptr != end)
    refuse("the color of " + name + " must be \"#rrggbb\", sRGB in hexadecimal");
  return rgb;
}

std::vector<std::array<float, 2>> points_of(const Json& json, const std::string& name) {
  if (!json.is_array()) refuse("the points of " + name + " must be a list, [[x, y], ...]");
  if (json.size() > kMaxPoints)
    refuse(name + " has " + std::to_string(json.size()) + " points; at most " +
           std::to_string(kMaxPoints) + " are possible: leave out some, or divide it in two");
  std::vector<std::array<float, 2>> points;
  for (const Json& point : json) {
    if (!point.is_array() || point.size() != 2)
      refuse("the points of " + name + " must be pairs, [[x, y], ...]");
    points.push_back(
        {number_of(point[0], -kMaxCoordinate, kMaxCoordinate, "x of a point of " + name),
         number_of(point[1], -kMaxCoordinate, kMaxCoordinate, "y of a point of " + name)});
  }
  return points;
}

OrderedJson points_json(const std::vector<std::array<float, 2>>& points) {
  OrderedJson json = OrderedJson::array();
  for (const auto& [x, y] : points) json.push_back({rounded(x, 1), rounded(y, 1)});
  return json;
}

std::vector<Json> entries_of(const std::string& text, const std::string& what, size_t max,
                             const std::string& limit, Extent& frame) {
  frame = {};
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) return {};
  Json entries = parsed(text, std::to_string(max) + " " + what + " of " + limit);
  if (entries.is_object()) {
    if (!entries.contains(what) || !entries.contains("frame") || entries.size() != 2)
      refuse("the text must be a list of " + what + ", or an object with \"frame\" and \"" + what +
             "\"");
    const Json& size = entries["frame"];
    if (!size.is_array() || size.size() != 2) refuse("\"frame\" must be [width, height]");
    frame = {static_cast<uint32_t>(number_of(size[0], 1, kMaxCoordinate, "the width")),
             static_cast<uint32_t>(number_of(size[1], 1, kMaxCoordinate, "the height"))};
    Json list = std::move(entries[what]);
    entries = std::move(list);
  }
  if (!entries.is_array()) refuse("the text must be a list of " + what);
  if (entries.size() > max)
    refuse("there are " + std::to_string(entries.size()) + " " + what + "; at most " +
           std::to_string(max) + " are possible: leave out some");
  return std::move(entries.get_ref<Json::array_t&>());
}

std::string text_of(OrderedJson entries, const std::string& what, Extent frame) {
  if (entries.empty()) return "";
  if (frame.pixels() == 0) return entries.dump();
  return OrderedJson{{"frame", {frame.width, frame.height}}, {what, std::move(entries)}}.dump();
}

std::string color_text(uint32_t argb) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%06x", argb & 0xffffffU);
  return text.data();
}

double rounded(float value, int digits) {
  const double factor = std::pow(10, digits);
  return std::round(static_cast<double>(value) * factor) / factor;
}

}  // namespace inverse::json_list
