// SPDX-License-Identifier: LGPL-2.1-or-later
#include "light_list.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/error.hpp"

namespace inverse {
namespace {

constexpr uintmax_t kMaxJsonBytes = uintmax_t{16} << 20;

[[noreturn]] void refuse(const std::string& text) { throw Error(ErrorKind::file, text); }

/// olat/NNN.exr
std::string usual_name(size_t light) {
  std::string number = std::to_string(light);
  number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
  return "olat/" + number + ".exr";
}

}  // namespace

LightList LightList::load(const std::string& path) {
  std::error_code error;
  const uintmax_t size = std::filesystem::file_size(path, error);
  if (error)
    refuse("cannot read " + path + ": " + error.message() +
           "; an OLAT folder has lights.json and olat/000.exr, 001.exr, …");
  if (size > kMaxJsonBytes) refuse(path + " is too large for a list of lights");
  std::ifstream file(path);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  return parse(text, path);
}

LightList LightList::parse(std::string_view text, const std::string& name) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) refuse(name + " is no JSON");
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
