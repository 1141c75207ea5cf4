// SPDX-License-Identifier: LGPL-2.1-or-later
// Light programs as JSON. Fields: docs/reference/light-program.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/error.hpp"
#include "common/json.hpp"
#include "common/open_file.hpp"
#include "common/replace_file.hpp"
#include "light_program.hpp"

namespace inverse {
namespace {

using Json = nlohmann::ordered_json;
constexpr const char* kFormat = "gst-inverse light program";
constexpr int kVersion = 1;
constexpr std::array kMarkers = {"none", "start", "pass"};

/// Reads the fields of one object; error messages name the object.
class Object {
 public:
  Object(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
    if (!json.is_object()) refuse("is not an object");
  }

  [[noreturn]] void refuse(const std::string& text) const {
    throw Error(ErrorKind::file, where_ + " " + text);
  }
  bool has(const char* field) const { return json_.contains(field); }
  /// Throws for other fields, so that a misspelled one is not ignored.
  void allow_only(std::initializer_list<std::string_view> fields) const {
    for (const auto& [name, value] : json_.items())
      if (std::find(fields.begin(), fields.end(), name) == fields.end() && name != "comment")
        refuse("has an unknown field \"" + name.substr(0, 40) + "\"");
  }
  const Json& field(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end()) refuse(std::string("has no \"") + name + "\"");
    return *found;
  }
  const Json& list(const char* name) const {
    if (!field(name).is_array()) refuse(std::string("has a \"") + name + "\" that is not a list");
    return field(name);
  }
  std::string text(const char* name) const {
    if (!field(name).is_string()) refuse(std::string("has a \"") + name + "\" that is not a text");
    return field(name).get<std::string>();
  }
  double number(const char* name) const {
    if (!field(name).is_number()) refuse(std::string("has a \"") + name + "\" that is no number");
    return field(name).get<double>();
  }
  uint64_t count(const char* name, uint64_t max) const {
    const Json& value = field(name);
    if (!value.is_number_unsigned() || value.get<uint64_t>() > max)
      refuse(std::string("has a \"") + name + "\" that is not a whole number from 0 to " +
             std::to_string(max));
    return value.get<uint64_t>();
  }
  /// Three numbers.
  template <typename T>
  std::array<T, 3> triple(const Json& json, const char* name) const {
    std::array<T, 3> out{};
    if (!json.is_array() || json.size() != 3)
      refuse(std::string("has a \"") + name + "\" that is not three numbers");
    for (size_t c = 0; c < 3; ++c) {
      if (!json[c].is_number())
        refuse(std::string("has a \"") + name + "\" that is not three numbers");
      out[c] = json[c].get<T>();
    }
    return out;
  }

 private:
  const Json& json_;
  std::string where_;
};

/// 60, 29.97 or "60000/1001".
void read_rate(const Object& object, LightProgram& program) {
  const Json& rate = object.field("rate");
  if (rate.is_string()) {
    std::istringstream text(rate.get<std::string>());
    char slash = 0;
    uint32_t numerator = 0, denominator = 0;
    if (!(text >> numerator >> slash >> denominator) || slash != '/' || !(text >> std::ws).eof())
      object.refuse("has a \"rate\" that is not like \"60000/1001\"");
    program.rate_numerator = numerator;
    program.rate_denominator = denominator;
    return;
  }
  const double value = object.number("rate");
  if (!(value > 0 && value <= 1e6)) object.refuse("has a \"rate\" outside of 0…1000000");
  const bool whole = value == std::floor(value);
  program.rate_numerator = static_cast<uint32_t>(std::lround(whole ? value : value * 1000));
  program.rate_denominator = whole ? 1 : 1000;
}

StageLight read_light(const Json& json, const std::string& where) {
  const Object object(json, where);
  object.allow_only({"index", "direction", "channels"});
  StageLight light;
  light.direction = object.triple<double>(object.field("direction"), "direction");
  if (object.has("channels"))
    for (const Json& channel : object.list("channels")) {
      if (!channel.is_number_unsigned() ||
          channel.get<uint64_t>() > std::numeric_limits<uint32_t>::max())
        object.refuse("has a channel that is not a whole number from 1");
      light.channels.push_back(channel.get<uint32_t>());
    }
  return light;
}

LightStep read_step(const Json& json, const std::string& where) {
  const Object object(json, where);
  object.allow_only({"kind", "light", "colors", "exposure", "guard"});
  LightStep step;
  const std::string kind = object.text("kind");
  bool known = false;
  for (int k = 0; k <= static_cast<int>(StepKind::custom); ++k)
    if (kind == name_of(static_cast<StepKind>(k))) {
      step.kind = static_cast<StepKind>(k);
      known = true;
    }
  if (!known)
    object.refuse("is of a kind \"" + kind.substr(0, 40) +
                  "\"; there are olat, gradient-a, gradient-b, tracking, black and custom");
  if (step.kind == StepKind::olat)
    step.light = static_cast<uint32_t>(object.count("light", LightProgram::kMaxLights - 1));
  if (step.kind == StepKind::custom)
    for (const Json& color : object.list("colors"))
      step.colors.push_back(object.triple<float>(color, "colors"));
  if (object.has("exposure")) step.exposure = object.number("exposure");
  if (object.has("guard")) step.guard = object.number("guard");
  return step;
}

/// The optional "index" of a light has to be its position in the list.
void check_index(const Json& light, size_t place, const std::string& where) {
  if (light.is_object() && light.contains("index") && light["index"] != place)
    throw Error(ErrorKind::file, where + " has an \"index\" that is not its position in the list");
}

Json write(const LightStep& step) {
  Json json = {{"kind", name_of(step.kind)}};
  if (step.kind == StepKind::olat) json["light"] = step.light;
  if (step.kind == StepKind::custom) json["colors"] = step.colors;
  if (step.exposure) json["exposure"] = *step.exposure;
  if (step.guard) json["guard"] = *step.guard;
  return json;
}

}  // namespace

LightProgram LightProgram::parse(std::string_view text, const std::string& name) {
  if (text.size() > kMaxFileBytes) throw Error(ErrorKind::file, name + " is longer than 64 MiB");
  std::string fault;
  const Json json = parse_json<Json>(text, fault);
  if (!fault.empty()) throw Error(ErrorKind::file, name + " " + fault);
  const Object object(json, name);
  if (object.text("format") != kFormat)
    object.refuse(std::string("is not a light program: its \"format\" is not \"") + kFormat + "\"");
  if (object.count("version", 1000000) != kVersion)
    object.refuse("has an unsupported version; this program reads version 1");
  object.allow_only({"format", "version", "name", "rate", "exposure", "guard", "repeat", "marker",
                     "lights", "steps"});
  LightProgram program;
  program.name = object.has("name") ? object.text("name") : name;
  read_rate(object, program);
  if (object.has("exposure")) program.exposure = object.number("exposure");
  if (object.has("guard")) program.guard = object.number("guard");
  if (object.has("repeat")) program.repeat = object.count("repeat", uint64_t{1} << 40);
  if (object.has("marker")) {
    const std::string marker = object.text("marker");
    size_t m = 0;
    while (m < kMarkers.size() && marker != kMarkers[m]) ++m;
    if (m == kMarkers.size())
      object.refuse("has a \"marker\" \"" + marker.substr(0, 40) +
                    "\"; there are none, start and pass");
    program.marker = static_cast<Marker>(m);
  }
  const Json& lights = object.list("lights");
  const Json& steps = object.list("steps");
  if (lights.size() > kMaxLights || steps.size() > kMaxSteps)
    object.refuse("has too many lights (" + std::to_string(kMaxLights) + ") or steps (" +
                  std::to_string(kMaxSteps) + ")");
  for (const Json& light : lights) {
    const std::string where = name + ": light " + std::to_string(program.lights.size());
    check_index(light, program.lights.size(), where);
    program.lights.push_back(read_light(light, where));
  }
  for (const Json& step : steps)
    program.steps.push_back(
        read_step(step, name + ": step " + std::to_string(program.steps.size())));
  program.check();
  return program;
}

LightProgram LightProgram::load(const std::string& path) {
  std::string fault;
  const std::string text = read_file(path, kMaxFileBytes, fault);
  if (!fault.empty()) throw Error(ErrorKind::file, "the light program " + path + " " + fault);
  return parse(text, path);
}

std::string LightProgram::json() const {
  Json json = {{"format", kFormat}, {"version", kVersion}, {"name", name}};
  if (rate_denominator == 1)
    json["rate"] = rate_numerator;
  else
    json["rate"] = std::to_string(rate_numerator) + "/" + std::to_string(rate_denominator);
  json["exposure"] = exposure;
  json["guard"] = guard;
  json["marker"] = kMarkers[static_cast<size_t>(marker)];
  json["repeat"] = repeat;
  // One line per light and step, so that files are easy to read and compare.
  std::string text = json.dump(2);
  text.resize(text.size() - 2);  // "\n}"
  const auto list = [&text](const char* field, const auto& items, const auto& to_json) {
    text += std::string(",\n  \"") + field + "\": [";
    for (size_t i = 0; i < items.size(); ++i)
      text += (i ? ",\n    " : "\n    ") + Json(to_json(i)).dump();
    text += "\n  ]";
  };
  list("lights", lights, [this](size_t i) {
    Json light = {{"index", i}, {"direction", lights[i].direction}};
    if (!lights[i].channels.empty()) light["channels"] = lights[i].channels;
    return light;
  });
  list("steps", steps, [this](size_t i) { return write(steps[i]); });
  return text + "\n}\n";
}

void LightProgram::save(const std::string& path) const { replace_file(path, json()); }

}  // namespace inverse
