// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_list.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/error.hpp"
#include "common/json.hpp"
#include "common/open_file.hpp"

namespace inverse {
namespace {

constexpr uint64_t kMaxJsonBytes = uint64_t{16} << 20;

[[noreturn]] void refuse(const std::string& text) { throw Error(ErrorKind::file, text); }

/// olat/NNN.exr
std::string usual_name(size_t light) {
  std::string number = std::to_string(light);
  number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
  return "olat/" + number + ".exr";
}

}  // namespace

LightList LightList::load(const std::string& path) {
  std::string fault;
  const std::string text = read_file(path, kMaxJsonBytes, fault);
  if (!fault.empty())
    refuse(path + " " + fault + "; an OLAT folder has lights.json and olat/000.exr, 001.exr, …");
  return parse(text, path);
}

LightList LightList::parse(std::string_view text, const std::string& name) {
  std::string fault;
  const auto json = parse_json<nlohmann::json>(text, fault);
  if (!fault.empty()) refuse(name + " " + fault);
  LightList lights;
  auto& directions = lights.directions;
  auto& files = lights.files;
  lights.captured = json.is_object() && json.value("format", nlohmann::json()) == kCapture;
  const bool plain = json.is_object() && json.contains("directions");
  const auto list =
      plain ? json["directions"]
            : (json.is_object() ? json.value("lights", nlohmann::json()) : nlohmann::json());
  if (!list.is_array() || list.empty()) refuse(name + " has no \"directions\" of lights");
  if (list.size() > LightProgram::kMaxLights)
    refuse(name + " has more than " + std::to_string(LightProgram::kMaxLights) + " lights");
  for (const auto& item : list) {
    const std::string where = name + ": light " + std::to_string(directions.size());
    const auto d =
        plain ? item : (item.is_object() ? item.value("direction", nlohmann::json()) : item);
    if (!d.is_array() || d.size() != 3 || !d[0].is_number() || !d[1].is_number() ||
        !d[2].is_number())
      refuse(where + " has no direction of three numbers");
    Direction direction{d[0].get<double>(), d[1].get<double>(), d[2].get<double>()};
    const double length = std::hypot(direction[0], direction[1], direction[2]);
    if (!(std::abs(length - 1) <= 1e-3))
      refuse(where + ": its direction is not a unit vector, its length is " +
             std::to_string(length));
    for (double& c : direction) c /= length;
    directions.push_back(direction);
    const auto file = item.is_object() ? item.value("file", nlohmann::json()) : nlohmann::json();
    if (!file.is_null() && !file.is_string()) refuse(where + ": its \"file\" is no text");
    files.push_back(file.is_string() ? file.get<std::string>() : "");
  }
  // A list without any file has the default names.
  if (std::ranges::all_of(files, [](const std::string& file) { return file.empty(); }))
    for (size_t i = 0; i < files.size(); ++i) files[i] = usual_name(i);
  return lights;
}

}  // namespace inverse
