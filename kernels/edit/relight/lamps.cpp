// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lamps.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/edit_relight_apply.spv.hpp"
#include "kernels/edit_relight_place.spv.hpp"

namespace inverse {
namespace {

using Shader = shaders::edit_relight_apply;
static_assert(Shader::kPoint == static_cast<int>(Lamp::Kind::point) &&
              Shader::kSpot == static_cast<int>(Lamp::Kind::spot) &&
              Shader::kDirectional == static_cast<int>(Lamp::Kind::directional));

constexpr float kMinDepth = 0.01F;  // meters from the camera
constexpr float kHardEdge = 2e-3F;  // minimum difference of cosines over which a cone's edge falls
constexpr double kDegree = 3.14159265358979323846 / 180;

float linear_of(uint32_t code) {
  const float v = static_cast<float>(code & 255) / 255;
  return v <= 0.04045F ? v / 12.92F : std::pow((v + 0.055F) / 1.055F, 2.4F);
}

Lamp::Vector unit(const Lamp::Vector& v) {
  const float length = std::hypot(v[0], v[1], v[2]);
  if (!(length > 0)) return {0, 0, -1};
  return {v[0] / length, v[1] / length, v[2] / length};
}

float ball_of(Extent frame) {
  return static_cast<float>(std::max(std::min(frame.width, frame.height), 1U)) / 2;
}

}  // namespace

Place place_of(const Lamp& lamp, Extent frame) {
  if (lamp.kind != Lamp::Kind::directional) return {lamp.position[0], lamp.position[1]};
  const Lamp::Vector direction = unit(lamp.direction);
  const float ball = ball_of(frame);
  return {static_cast<float>(frame.width) / 2 - ball * direction[0],
          static_cast<float>(frame.height) / 2 - ball * direction[1]};
}

void move_to(Lamp& lamp, Place place, Extent frame) {
  if (lamp.kind != Lamp::Kind::directional) {
    lamp.position[0] = place[0], lamp.position[1] = place[1];
    return;
  }
  const float ball = ball_of(frame);
  const float x = (static_cast<float>(frame.width) / 2 - place[0]) / ball;
  const float y = (static_cast<float>(frame.height) / 2 - place[1]) / ball;
  const float above = 1 - x * x - y * y;
  lamp.direction = above > 0 ? Lamp::Vector{x, y, -std::sqrt(above)} : unit({x, y, 0});
}

float View::depth(float z) const { return std::max(plane_depth - z, kMinDepth); }

Lamp::Vector View::place(float x, float y, float z) const {
  const float depth = this->depth(z);
  const float scale = focal_length > 0 ? depth / focal_length : 1 / static_cast<float>(frame.width);
  return {(x - static_cast<float>(frame.width) / 2) * scale,
          (y - static_cast<float>(frame.height) / 2) * scale,
          focal_length > 0 ? plane_depth - depth : z};
}

std::vector<std::array<float, 4>> lamp_table(const std::vector<Lamp>& lamps, float strength,
                                             const View& view, bool in_scene) {
  using Given = shaders::edit_relight_place;
  std::vector<std::array<float, 4>> table;
  for (const Lamp& lamp : lamps) {
    if (table.size() == kMaxLamps * Shader::kLampRows) break;
    Lamp::Vector at = lamp.position;
    if (!lamp.room)
      at = in_scene ? Lamp::Vector{0, 0, view.depth(lamp.position[2])}
                    : view.place(lamp.position[0], lamp.position[1], lamp.position[2]);
    const int axes = lamp.room ? Given::kOfRoom : in_scene ? Given::kOfCamera : 0;
    const Lamp::Vector axis = unit(lamp.direction);
    const float power = lamp.power * strength;
    const double edge = static_cast<double>(lamp.angle) * kDegree;
    const auto cos_edge = static_cast<float>(std::cos(edge));
    const auto cos_full =
        static_cast<float>(std::cos(edge * (1 - static_cast<double>(lamp.softness))));
    const Place mark = place_of(lamp, view.frame);
    const auto channel = [&](uint32_t shift) { return linear_of(lamp.color >> shift); };
    table.push_back({at[0], at[1], at[2], lamp.radius * lamp.radius});
    table.push_back(
        {axis[0], axis[1], axis[2], static_cast<float>(static_cast<int>(lamp.kind) + axes)});
    table.push_back({power * channel(16), power * channel(8), power * channel(0), cos_edge});
    table.push_back({mark[0], mark[1], 1 / std::max(cos_full - cos_edge, kHardEdge),
                     static_cast<float>(lamp.color & 0xffffff)});
  }
  return table;
}

}  // namespace inverse
