// SPDX-License-Identifier: LGPL-2.1-or-later
#include "virtual_room.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace inverse {
namespace {

using shaders::depth_virtual_room_open;
using shaders::depth_virtual_room_room;
using Vec3 = std::array<float, 3>;

/// Solids and lamps as room.glsl reads them.
std::vector<float> table_of(const RoomScene& scene) {
  constexpr size_t kStride = 4 * depth_virtual_room_room::kSolidStride;
  std::vector<float> table(kStride * std::max(scene.solids.size(), scene.lamps.size()));
  const auto put = [&](size_t solid, uint32_t slot, const Vec3& xyz, float w) {
    float* to = &table[kStride * solid + 4 * slot];
    std::copy(xyz.begin(), xyz.end(), to);
    to[3] = w;
  };
  for (size_t i = 0; i < scene.solids.size(); ++i) {
    const Solid& s = scene.solids[i];
    constexpr float kKinds[] = {depth_virtual_room_room::kBox, depth_virtual_room_room::kBall,
                                depth_virtual_room_room::kInside};
    constexpr float kPaints[] = {depth_virtual_room_room::kPlain, depth_virtual_room_room::kChecker,
                                 depth_virtual_room_room::kStripes, depth_virtual_room_room::kRings,
                                 depth_virtual_room_room::kLetters};
    put(i, depth_virtual_room_room::kCenter, s.center, kKinds[static_cast<size_t>(s.kind)]);
    put(i, depth_virtual_room_room::kExtent, s.half_size, kPaints[static_cast<size_t>(s.paint)]);
    put(i, depth_virtual_room_room::kTurn, {std::cos(s.turn), std::sin(s.turn), 0}, s.side);
    put(i, depth_virtual_room_room::kPaint, s.color, 0);
    put(i, depth_virtual_room_room::kOther, s.other, 0);
  }
  for (size_t i = 0; i < scene.lamps.size(); ++i)
    put(i, depth_virtual_room_room::kLamp, scene.lamps[i].place, scene.lamps[i].power);
  return table;
}

/// The pose of a camera that looks at a target, upright.
Pose looking(const std::array<double, 3>& place, const std::array<double, 3>& target) {
  const double dx = target[0] - place[0], dy = target[1] - place[1], dz = target[2] - place[2];
  const double yaw = std::atan2(dx, dz) / 2, pitch = -std::atan2(dy, std::hypot(dx, dz)) / 2;
  // About y, then about the camera's x.
  const double cy = std::cos(yaw), sy = std::sin(yaw), cx = std::cos(pitch), sx = std::sin(pitch);
  return {{float(cy * sx), float(sy * cx), float(-sy * sx), float(cy * cx)},
          {float(place[0]), float(place[1]), float(place[2]), 0}};
}

}  // namespace

RoomScene furnished_room() {
  using Kind = Solid::Kind;
  using Paint = Solid::Paint;
  constexpr Vec3 kWhite{0.75F, 0.74F, 0.72F}, kBlack{0.04F, 0.04F, 0.045F},
      kGray{0.28F, 0.28F, 0.29F}, kWood{0.42F, 0.26F, 0.14F}, kDarkWood{0.12F, 0.07F, 0.045F},
      kRed{0.5F, 0.07F, 0.06F}, kBlue{0.07F, 0.14F, 0.4F}, kGreen{0.12F, 0.33F, 0.13F},
      kYellow{0.68F, 0.5F, 0.1F}, kCream{0.66F, 0.6F, 0.48F};
  RoomScene scene;
  scene.solids = {
      {Kind::inside, {0, 0, 0}, {2.4F, 1.25F, 2.1F}, 0, Paint::plain, 0.4F, kCream, kCream},
      {Kind::box, {0, 1.24F, 0}, {2.39F, 0.01F, 2.09F}, 0, Paint::checker, 0.45F, kWood, kDarkWood},
      // A table with what lies on it.
      {Kind::box,
       {0, 0.5F, 0.1F},
       {0.7F, 0.03F, 0.45F},
       0.2F,
       Paint::stripes,
       0.12F,
       kWood,
       kCream},
      {Kind::box,
       {-0.5F, 0.87F, -0.2F},
       {0.04F, 0.35F, 0.04F},
       0.2F,
       Paint::plain,
       1,
       kDarkWood,
       {}},
      {Kind::box,
       {0.6F, 0.87F, -0.1F},
       {0.04F, 0.35F, 0.04F},
       0.2F,
       Paint::plain,
       1,
       kDarkWood,
       {}},
      {Kind::box,
       {-0.55F, 0.87F, 0.35F},
       {0.04F, 0.35F, 0.04F},
       0.2F,
       Paint::plain,
       1,
       kDarkWood,
       {}},
      {Kind::box,
       {0.5F, 0.87F, 0.45F},
       {0.04F, 0.35F, 0.04F},
       0.2F,
       Paint::plain,
       1,
       kDarkWood,
       {}},
      {Kind::ball,
       {0.3F, 0.33F, 0.0F},
       {0.14F, 0.14F, 0.14F},
       0,
       Paint::checker,
       0.1F,
       kRed,
       kWhite},
      {Kind::ball, {-0.1F, 0.38F, 0.3F}, {0.09F, 0.09F, 0.09F}, 0, Paint::plain, 1, kBlack, {}},
      {Kind::box,
       {-0.35F, 0.35F, 0.05F},
       {0.12F, 0.12F, 0.09F},
       0.6F,
       Paint::letters,
       0.03F,
       kWhite,
       kBlack},
      {Kind::box,
       {0.05F, 0.455F, -0.15F},
       {0.15F, 0.015F, 0.11F},
       -0.3F,
       Paint::letters,
       0.02F,
       kYellow,
       kBlue},
      // Along the walls.
      {Kind::box,
       {-2.1F, 0.5F, -0.5F},
       {0.25F, 0.74F, 0.6F},
       0,
       Paint::stripes,
       0.25F,
       kDarkWood,
       kGray},
      {Kind::box, {-2.0F, -0.36F, -0.5F}, {0.12F, 0.12F, 0.2F}, 0.3F, Paint::plain, 1, kGreen, {}},
      {Kind::box, {1.7F, 0.85F, 1.6F}, {0.5F, 0.38F, 0.35F}, -0.2F, Paint::plain, 1, kBlue, {}},
      {Kind::box,
       {1.78F, 0.32F, 1.9F},
       {0.5F, 0.3F, 0.1F},
       -0.2F,
       Paint::stripes,
       0.08F,
       kBlue,
       kGray},
      {Kind::ball,
       {-1.6F, 1.0F, 1.5F},
       {0.24F, 0.24F, 0.24F},
       0,
       Paint::stripes,
       0.12F,
       kYellow,
       kRed},
      {Kind::box,
       {1.9F, 0.75F, -1.4F},
       {0.3F, 0.48F, 0.3F},
       0.5F,
       Paint::checker,
       0.15F,
       kWhite,
       kBlack},
      // Pictures on the wall in front and behind.
      {Kind::box,
       {-0.9F, -0.35F, 2.098F},
       {0.45F, 0.35F, 0.004F},
       0,
       Paint::rings,
       0.07F,
       kWhite,
       kBlue},
      {Kind::box,
       {0.35F, -0.3F, 2.098F},
       {0.5F, 0.42F, 0.004F},
       0,
       Paint::letters,
       0.06F,
       kWhite,
       kBlack},
      {Kind::box,
       {1.5F, -0.4F, 2.098F},
       {0.3F, 0.3F, 0.004F},
       0,
       Paint::checker,
       0.1F,
       kGray,
       kGreen},
      {Kind::box,
       {0.2F, -0.2F, -2.098F},
       {0.9F, 0.5F, 0.004F},
       0,
       Paint::stripes,
       0.11F,
       kRed,
       kCream},
  };
  scene.lamps = {{{0.6F, -1.15F, 0.3F}, 1.5F}, {{-1.3F, -1.1F, -1.2F}, 0.7F}};
  return scene;
}

Pose room_pose(RoomPath path, double seconds) {
  const double turn = 2 * std::numbers::pi * seconds / kPathPeriod;
  switch (path) {
    case RoomPath::orbit:
      return looking(
          {1.45 * std::sin(turn), -0.25 + 0.15 * std::sin(2 * turn), -1.35 * std::cos(turn)},
          {0.15 * std::sin(2 * turn), 0.45, 0.1});
    case RoomPath::wall:
      return looking(
          {0.9 * std::sin(turn), -0.35 + 0.12 * std::sin(3 * turn), 0.85},
          {0.9 * std::sin(turn) + 0.05 * std::cos(turn), -0.35 + 0.12 * std::sin(3 * turn), 2.1});
    case RoomPath::table:
      return looking({0.08 * std::sin(3 * turn), -0.18 + 0.03 * std::sin(5 * turn),
                      -0.62 + 0.03 * std::cos(2 * turn)},
                     {-0.02 + 0.03 * std::sin(2 * turn), 0.4, 0.08});
    case RoomPath::still:
      break;
  }
  return looking({0, -0.25, -1.35}, {0, 0.45, 0.1});
}

Lens room_lens(Extent extent) {
  const float focal =
      0.5F * float(extent.width) / std::tan(0.5F * 62 * std::numbers::pi_v<float> / 180);
  return {focal, focal, 0.5F * float(extent.width - 1), 0.5F * float(extent.height - 1)};
}

VirtualRoom::VirtualRoom(const std::shared_ptr<gpu::Device>& device, const RoomScene& scene)
    : room_(device),
      sensor_(device),
      scene_(gpu::make_table(device, gpu::Element::vec4, table_of(scene))),
      solids_(static_cast<uint32_t>(scene.solids.size())),
      lamps_(static_cast<uint32_t>(scene.lamps.size())),
      ambient_(scene.ambient) {
  const gpu::Program<shaders::depth_virtual_room_open> open(device);
  const uint32_t places =
      solids_ * 6 * depth_virtual_room_open::kOpenSide * depth_virtual_room_open::kOpenSide;
  openness_ = gpu::Buffer::create(device, gpu::Element::scalar, places);
  gpu::Commands commands(device);
  commands.begin();
  commands.dispatch(open, {.scene = scene_, .openness = openness_}, {.solids = solids_}, places);
  commands.submit();
  commands.wait();
}

void VirtualRoom::record(gpu::Commands& commands, const Lens& lens, Extent extent,
                         const gpu::BufferPtr& pose, uint32_t side, const gpu::BufferPtr& layers,
                         const gpu::BufferPtr& truth, const std::vector<HandPart>& hand) {
  std::vector<std::array<float, 4>> parts;
  for (const HandPart& part : hand) {
    parts.push_back({part.from[0], part.from[1], part.from[2], part.radius});
    parts.push_back({part.to[0], part.to[1], part.to[2], 0});
    parts.push_back({part.color[0], part.color[1], part.color[2], 0});
  }
  if (parts.empty()) parts.emplace_back();
  commands.write_table(hand_, gpu::Element::vec4, parts);
  commands.dispatch(room_,
                    {.scene = scene_,
                     .openness = openness_,
                     .pose = pose,
                     .layers = layers,
                     .truth = truth,
                     .hand = hand_},
                    {.lens = lens.values(),
                     .size = extent,
                     .side = side,
                     .solids = solids_,
                     .lamps = lamps_,
                     .ambient = ambient_,
                     .parts = static_cast<uint32_t>(hand.size())},
                    static_cast<uint32_t>(extent.pixels()));
}

void VirtualRoom::record_sensor(gpu::Commands& commands, Extent extent,
                                const gpu::BufferPtr& layers, const gpu::BufferPtr& truth,
                                const Sensor& sensor, uint32_t frame,
                                const gpu::BufferPtr& depth) const {
  commands.dispatch(sensor_, {.layers = layers, .truth = truth, .depth = depth},
                    {.size = extent,
                     .amount = sensor.noise,
                     .max_depth = sensor.max_depth,
                     .seed = sensor.seed,
                     .frame = frame},
                    static_cast<uint32_t>(extent.pixels()));
}

}  // namespace inverse
