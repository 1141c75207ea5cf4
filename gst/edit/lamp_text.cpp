// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lamp_text.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "gst/base/json/json_list.hpp"

namespace inverse {
namespace {

using namespace json_list;

constexpr float kMaxHeight = 1000;
constexpr const char* kLimit = "nine fields";

constexpr std::array kKinds{"point", "spot", "directional"};  // by Lamp::Kind

Lamp::Vector vector_of(const Json& json, float high, float high_z, const std::string& name) {
  if (!json.is_array() || json.size() != 3) refuse(name + " must be [x, y, z]");
  return {number_of(json[0], -high, high, "x of " + name),
          number_of(json[1], -high, high, "y of " + name),
          number_of(json[2], -high_z, high_z, "z of " + name)};
}

Lamp::Kind kind_of(const Json& json, const std::string& name) {
  for (size_t k = 0; k < kKinds.size(); ++k)
    if (json == kKinds[k]) return static_cast<Lamp::Kind>(k);
  refuse(name + " must have the kind \"point\", \"spot\" or \"directional\"");
}

Lamp lamp_of(const Json& json, const std::string& name) {
  if (!json.is_object()) refuse(name + " must be an object with kind and position");
  Lamp lamp;
  if (const auto room = json.find("room"); room != json.end()) {
    if (!room->is_boolean()) refuse("the room of " + name + " must be true or false");
    lamp.room = room->get<bool>();
  }
  std::set<std::string> given;
  for (const auto& [key, value] : json.items()) {
    given.insert(key);
    const std::string of = key.substr(0, 40) + " of " + name;
    if (key == "kind") {
      lamp.kind = kind_of(value, name);
    } else if (key == "position") {
      lamp.position = vector_of(value, lamp.room ? kMaxHeight : kMaxCoordinate, kMaxHeight,
                                "the position of " + name);
    } else if (key == "direction") {
      lamp.direction = vector_of(value, kMaxCoordinate, kMaxCoordinate, "the direction of " + name);
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
    } else if (key != "room") {
      refuse(
          name + " has the field \"" + key.substr(0, 40) +
          "\", but only kind, position, direction, color, power, angle, softness, radius and room "
          "are known");
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

/// The number with five digits, which is 0 only if the number is.
double short_of(float value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.5g", static_cast<double>(value));
  return std::strtod(text.data(), nullptr);
}

OrderedJson json_of(const Lamp& lamp) {
  constexpr int kFine = 4;  // digits
  const int of_place = lamp.room ? kFine : 1;
  OrderedJson entry{{"kind", kKinds[static_cast<size_t>(lamp.kind)]}};
  const bool directional = lamp.kind == Lamp::Kind::directional;
  if (!directional)
    entry["position"] = {rounded(lamp.position[0], of_place), rounded(lamp.position[1], of_place),
                         rounded(lamp.position[2], kFine)};
  if (lamp.kind != Lamp::Kind::point)
    entry["direction"] = {short_of(lamp.direction[0]), short_of(lamp.direction[1]),
                          short_of(lamp.direction[2])};
  entry["color"] = color_text(lamp.color);
  entry["power"] = short_of(lamp.power);
  if (lamp.kind == Lamp::Kind::spot) {
    entry["angle"] = short_of(lamp.angle);
    entry["softness"] = short_of(lamp.softness);
  }
  if (!directional) entry["radius"] = short_of(lamp.radius);
  if (lamp.room) entry["room"] = true;
  return entry;
}

}  // namespace

LampList read_lamps(const std::string& text) {
  LampList list;
  for (const Json& lamp : entries_of(text, "lamps", kMaxLamps, kLimit, list.frame))
    list.lamps.push_back(lamp_of(lamp, "lamp " + std::to_string(list.lamps.size() + 1)));
  return list;
}

Lamp read_lamp(const std::string& text) { return lamp_of(parsed(text, kLimit), "the lamp"); }

std::string text_of(const LampList& list) {
  OrderedJson lamps = OrderedJson::array();
  for (const Lamp& lamp : list.lamps) lamps.push_back(json_of(lamp));
  return json_list::text_of(std::move(lamps), "lamps", list.frame);
}

}  // namespace inverse
