// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lamp_text.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "common/error.hpp"
#include "common/json.hpp"

namespace inverse {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

constexpr float kMaxPixels = 1e6F, kMaxHeight = 1000;

constexpr std::array kKinds{"point", "spot", "directional"};  // by Lamp::Kind

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorKind::unsupported, what); }

Json parsed(const std::string& text) {
  std::string fault;
  Json json = parse_json<Json>(text, fault);
  if (json.is_discarded()) refuse(fault);
  return json;
}

float number_of(const Json& json, float low, float high, const std::string& name) {
  const auto value = static_cast<float>(json.is_number() ? json.get<double>() : NAN);
  if (!(value >= low && value <= high)) {
    std::array<char, 80> range{};
    std::snprintf(range.data(), range.size(), " must be a number from %g to %g",
                  static_cast<double>(low), static_cast<double>(high));
    refuse(name + range.data());
  }
  return value;
}

Lamp::Vector vector_of(const Json& json, float high, float high_z, const std::string& name) {
  if (!json.is_array() || json.size() != 3) refuse(name + " must be [x, y, z]");
  return {number_of(json[0], -high, high, "x of " + name),
          number_of(json[1], -high, high, "y of " + name),
          number_of(json[2], -high_z, high_z, "z of " + name)};
}

uint32_t color_of(const Json& json, const std::string& name) {
  const std::string text = json.is_string() ? json.get<std::string>() : "";
  constexpr size_t kLength = 7;
  if (text.size() != kLength || text[0] != '#' ||
      text.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
    refuse("the color of " + name + " must be \"#rrggbb\"");
  return static_cast<uint32_t>(std::stoul(text.substr(1), nullptr, 16));
}

Lamp::Kind kind_of(const Json& json, const std::string& name) {
  for (size_t k = 0; k < kKinds.size(); ++k)
    if (json == kKinds[k]) return static_cast<Lamp::Kind>(k);
  refuse(name + " must have the kind \"point\", \"spot\" or \"directional\"");
}

Lamp lamp_of(const Json& json, const std::string& name) {
  if (!json.is_object()) refuse(name + " must be an object with kind and position");
  Lamp lamp;
  std::set<std::string> given;
  for (const auto& [key, value] : json.items()) {
    given.insert(key);
    const std::string of = key.substr(0, 40) + " of " + name;
    if (key == "kind") {
      lamp.kind = kind_of(value, name);
    } else if (key == "position") {
      lamp.position = vector_of(value, kMaxPixels, kMaxHeight, "the position of " + name);
    } else if (key == "direction") {
      lamp.direction = vector_of(value, kMaxPixels, kMaxPixels, "the direction of " + name);
      if (!(std::hypot(lamp.direction[0], lamp.direction[1], lamp.direction[2]) > 0))
        refuse("the direction of " + name + " must not be [0, 0, 0]");
    } else if (key == "color") {
      lamp.color = color_of(value, name);
    } else if (key == "power") {
      lamp.power = number_of(value, 0, 1e6F, "the " + of);
    } else if (key == "angle") {
      lamp.angle = number_of(value, 0.1F, 180, "the " + of);
    } else if (key == "softness") {
      lamp.softness = number_of(value, 0, 1, "the " + of);
    } else if (key == "radius") {
      lamp.radius = number_of(value, 0, kMaxHeight, "the " + of);
    } else {
      refuse(name + " has the field \"" + key.substr(0, 40) +
             "\", but only kind, position, direction, color, power, angle, softness and radius are "
             "known");
    }
  }
  if (!given.contains("kind"))
    refuse(name + " must have the kind \"point\", \"spot\" or \"directional\"");
  const char* needed = lamp.kind == Lamp::Kind::directional ? "direction" : "position";
  if (!given.contains(needed))
    refuse(name + " is " + kKinds[static_cast<size_t>(lamp.kind)] + " and must have a " + needed +
           ", [x, y, z]");
  return lamp;
}

/// The number with so many digits behind the point.
double rounded(float value, double digits) {
  const double factor = std::pow(10, digits);
  return std::round(static_cast<double>(value) * factor) / factor;
}

/// The number with five digits, which is 0 only if the number is.
double short_of(float value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.5g", static_cast<double>(value));
  return std::strtod(text.data(), nullptr);
}

OrderedJson json_of(const Lamp& lamp) {
  constexpr double kFine = 4;  // digits
  OrderedJson entry{{"kind", kKinds[static_cast<size_t>(lamp.kind)]}};
  const bool directional = lamp.kind == Lamp::Kind::directional;
  if (!directional)
    entry["position"] = {rounded(lamp.position[0], 1), rounded(lamp.position[1], 1),
                         rounded(lamp.position[2], kFine)};
  if (lamp.kind != Lamp::Kind::point)
    entry["direction"] = {short_of(lamp.direction[0]), short_of(lamp.direction[1]),
                          short_of(lamp.direction[2])};
  std::array<char, 8> color{};
  std::snprintf(color.data(), color.size(), "#%06x", lamp.color & 0xffffff);
  entry["color"] = color.data();
  entry["power"] = short_of(lamp.power);
  if (lamp.kind == Lamp::Kind::spot) {
    entry["angle"] = short_of(lamp.angle);
    entry["softness"] = short_of(lamp.softness);
  }
  if (!directional) entry["radius"] = short_of(lamp.radius);
  return entry;
}

}  // namespace

LampList read_lamps(const std::string& text) {
  LampList list;
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) return list;
  const Json json = parsed(text);
  const Json* lamps = &json;
  if (json.is_object()) {
    if (!json.contains("lamps") || !json.contains("frame") || json.size() != 2)
      refuse("must be a list of lamps, or an object with \"frame\" and \"lamps\"");
    const Json& frame = json["frame"];
    if (!frame.is_array() || frame.size() != 2) refuse("\"frame\" must be [width, height]");
    list.frame = {static_cast<uint32_t>(number_of(frame[0], 1, kMaxPixels, "the width")),
                  static_cast<uint32_t>(number_of(frame[1], 1, kMaxPixels, "the height"))};
    lamps = &json["lamps"];
  }
  if (!lamps->is_array()) refuse("must be a list of lamps");
  if (lamps->size() > kMaxLamps)
    refuse("has " + std::to_string(lamps->size()) + " lamps; at most " + std::to_string(kMaxLamps) +
           " are possible");
  for (const Json& lamp : *lamps)
    list.lamps.push_back(lamp_of(lamp, "lamp " + std::to_string(list.lamps.size() + 1)));
  return list;
}

Lamp read_lamp(const std::string& text) { return lamp_of(parsed(text), "the lamp"); }

std::string text_of(const LampList& list) {
  if (list.lamps.empty()) return "";
  OrderedJson lamps = OrderedJson::array();
  for (const Lamp& lamp : list.lamps) lamps.push_back(json_of(lamp));
  if (list.frame.pixels() == 0) return lamps.dump();
  return OrderedJson{{"frame", {list.frame.width, list.frame.height}}, {"lamps", std::move(lamps)}}
      .dump();
}

}  // namespace inverse
