// SPDX-License-Identifier: LGPL-2.1-or-later
// Built-in stages and programs.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>

#include "common/error.hpp"
#include "light_list.hpp"
#include "light_program.hpp"

namespace inverse {
namespace {

constexpr uint32_t kDefaultLights = 331;
constexpr uint32_t kOlatsBetweenTracking = 11;
constexpr uint32_t kUniverse = 512;

Direction normalized(const Direction& d) {
  const double length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  return {d[0] / length, d[1] / length, d[2] / length};
}

struct Icosahedron {
  std::vector<Direction> corners;
  std::vector<std::array<size_t, 3>> faces;
};

/// One corner at the top, so that rings of lights are horizontal.
Icosahedron icosahedron() {
  Icosahedron solid;
  const double height = 1 / std::sqrt(5.0), radius = 2 / std::sqrt(5.0);
  solid.corners.push_back({0, 1, 0});
  for (const double side : {1.0, -1.0})
    for (int k = 0; k < 5; ++k) {
      const double angle = (2 * k + (side < 0 ? 1 : 0)) * std::numbers::pi / 5;
      solid.corners.push_back({radius * std::sin(angle), side * height, radius * std::cos(angle)});
    }
  solid.corners.push_back({0, -1, 0});
  for (size_t k = 0; k < 5; ++k) {
    const size_t next = (k + 1) % 5;
    solid.faces.push_back({0, 1 + k, 1 + next});
    solid.faces.push_back({1 + k, 6 + k, 1 + next});
    solid.faces.push_back({1 + next, 6 + k, 6 + next});
    solid.faces.push_back({11, 6 + next, 6 + k});
  }
  return solid;
}

std::vector<Direction> subdivided(uint32_t frequency) {
  const Icosahedron solid = icosahedron();
  std::map<std::array<long, 3>, Direction> found;  // corners and edges belong to several faces
  for (const auto& [a, b, c] : solid.faces)
    for (uint32_t i = 0; i <= frequency; ++i)
      for (uint32_t j = 0; i + j <= frequency; ++j) {
        Direction p{};
        for (size_t k = 0; k < 3; ++k)
          p[k] = i * solid.corners[a][k] + j * solid.corners[b][k] +
                 (frequency - i - j) * solid.corners[c][k];
        p = normalized(p);
        found.try_emplace(
            {std::lround(p[0] * 1e6), std::lround(p[1] * 1e6), std::lround(p[2] * 1e6)}, p);
      }
  std::vector<Direction> all;
  all.reserve(found.size());
  for (const auto& [key, direction] : found) all.push_back(direction);
  return all;
}

LightProgram program_of(const char* name, std::vector<StageLight> lights, uint32_t rate) {
  LightProgram program;
  program.name = name;
  program.rate_numerator = rate;
  program.lights = std::move(lights);
  return program;
}

}  // namespace

std::vector<Direction> geodesic_directions(uint32_t count) {
  uint32_t frequency = 1;
  while (10 * frequency * frequency + 2 < count) ++frequency;
  std::vector<Direction> all = subdivided(frequency);
  // From the top down; within a ring, from the camera to the right.
  std::sort(all.begin(), all.end(), [](const Direction& a, const Direction& b) {
    if (std::abs(a[1] - b[1]) > 1e-9) return a[1] > b[1];
    const auto around = [](const Direction& d) {
      const double angle = std::atan2(d[0], d[2]);
      return angle < -1e-9 ? angle + 2 * std::numbers::pi : angle;
    };
    return around(a) < around(b);
  });
  all.resize(count);
  return all;
}

std::vector<StageLight> stage_lights(const std::vector<Direction>& directions) {
  std::vector<StageLight> lights;
  uint32_t channel = 1;
  for (const Direction& direction : directions) {
    if ((channel - 1) % kUniverse + 3 > kUniverse) channel += kUniverse - (channel - 1) % kUniverse;
    lights.push_back({direction, {channel, channel + 1, channel + 2}});
    channel += 3;
  }
  return lights;
}

LightProgram static_capture(std::vector<StageLight> lights, uint32_t rate) {
  LightProgram program = program_of("static", std::move(lights), rate);
  const auto count = static_cast<uint32_t>(program.lights.size());
  for (uint32_t i = 0; i < count; ++i) {
    program.steps.push_back({StepKind::olat, i});
    if ((i + 1) % kOlatsBetweenTracking == 0 || i + 1 == count)
      program.steps.push_back({StepKind::tracking});
  }
  program.steps.push_back({StepKind::gradient_a});
  program.steps.push_back({StepKind::gradient_b});
  program.check();
  return program;
}

LightProgram performance(std::vector<StageLight> lights, uint32_t rate) {
  LightProgram program = program_of("performance", std::move(lights), rate);
  program.steps = {{StepKind::gradient_a}, {StepKind::gradient_b}};
  program.repeat = 0;
  program.check();
  return program;
}

bool is_built_in_program(const std::string& name_or_path) {
  const std::string name = name_or_path.substr(0, name_or_path.find(':'));
  return name == "performance" || name == "static";
}

LightProgram light_program(const std::string& name_or_path, uint32_t rate) {
  if (!is_built_in_program(name_or_path)) return LightProgram::load(name_or_path);
  const size_t colon = name_or_path.find(':');
  const std::string name = name_or_path.substr(0, colon);
  uint32_t count = kDefaultLights;
  const std::string after = colon == std::string::npos ? "" : name_or_path.substr(colon + 1);
  const bool listed = std::filesystem::is_directory(after);
  if (colon != std::string::npos && !listed) {
    const char *first = after.data(), *last = first + after.size();
    const auto [end, error] = std::from_chars(first, last, count);
    if (error != std::errc{} || end != last || count < 1 || count > LightProgram::kMaxLights)
      throw Error(ErrorKind::file, "\"" + name_or_path + "\": the number of lights is from 1 to " +
                                       std::to_string(LightProgram::kMaxLights) +
                                       ", and no folder is called " + after);
  }
  auto lights = stage_lights(listed ? LightList::load(after + "/lights.json").directions
                                    : geodesic_directions(count));
  return name == "static" ? static_capture(std::move(lights), rate)
                          : performance(std::move(lights), rate);
}

}  // namespace inverse
