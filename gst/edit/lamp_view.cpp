// SPDX-License-Identifier: LGPL-2.1-or-later
#include "lamp_view.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

constexpr float kNearest = 0.01F;  // meters from the camera

/// From the axes of the camera, z forward, to those of lamps over a picture, z to the viewer; and
/// back.
Lamp::Vector facing(const Lamp::Vector& v) { return {v[0], v[1], -v[2]}; }

Lamp::Vector turned(const Pose& pose, const Lamp::Vector& v, bool back) {
  Pose turn{pose.rotation, {}};
  return back ? to_camera(turn, v) : to_world(turn, v);
}

}  // namespace

std::optional<Lamp> LampView::over(const Lamp& in_room, Extent frame) const {
  Lamp lamp = in_room;
  lamp.room = false;
  lamp.direction = facing(turned(pose, in_room.direction, true));
  if (lamp.kind == Lamp::Kind::directional) return lamp;
  const auto at = to_camera(pose, in_room.position);
  if (!(at[2] > kNearest)) return {};
  const auto [x, y] = projected(lens, at);
  const Place pixel = scaled({x + .5F, y + .5F}, extent, frame);
  lamp.position = {pixel[0], pixel[1], at[2]};
  return lamp;
}

Lamp LampView::in_room(const Lamp& over, Extent frame) const {
  Lamp lamp = over;
  lamp.room = true;
  lamp.direction = turned(pose, facing(over.direction), false);
  if (lamp.kind == Lamp::Kind::directional) return lamp;
  const Place pixel = scaled({over.position[0], over.position[1]}, frame, extent);
  const float depth = std::max(over.position[2], kNearest);
  lamp.position = to_world(pose, {(pixel[0] - .5F - lens.cx) / lens.fx * depth,
                                  (pixel[1] - .5F - lens.cy) / lens.fy * depth, depth});
  return lamp;
}

float LampView::depth_at(Place place, Extent frame) const {
  const Place pixel = scaled(place, frame, extent);
  if (depth.empty() || !(pixel[0] >= 0 && pixel[1] >= 0)) return 0;
  const auto x = static_cast<uint32_t>(pixel[0]), y = static_cast<uint32_t>(pixel[1]);
  return x < extent.width && y < extent.height ? depth[size_t{y} * extent.width + x] : 0;
}

void LampViews::record(gpu::Commands& commands, uint64_t number, const SeenScene* scene,
                       bool with_depth) {
  Read& read = reads_[number];
  read.any = scene != nullptr;
  if (!scene) return;
  read.has_depth = with_depth;
  read.extent = scene->extent;
  read.lens = scene->lens;
  const auto copy = [&](const gpu::BufferPtr& from, gpu::BufferPtr& to) {
    if (!to || to->count() != from->count())
      to = gpu::Buffer::create(device_, gpu::Element::vec4, from->count(), gpu::Memory::readback);
    commands.copy(from, to, from->bytes());
    commands.count_download(from->bytes());
  };
  copy(scene->pose->buffer, read.pose);
  if (with_depth) copy(scene->surface->buffer, read.surface);
  // Their pools write them again once nobody holds them, which is not before this is submitted.
  commands.keep(scene->pose);
  commands.keep(scene->surface);
}

std::optional<LampView> LampViews::view(uint64_t number) const {
  const Read& read = reads_[number];
  if (!read.any) return {};
  const auto* values = read.pose->map_as<float>();
  if (!(values[8] > 0)) return {};
  LampView view{.extent = read.extent, .lens = read.lens, .pose = {}, .depth = {}};
  std::copy_n(values, 4, view.pose.rotation.begin());
  std::copy_n(values + 4, 4, view.pose.place.begin());
  if (read.has_depth) {
    const auto* surface = read.surface->map_as<float>();
    for (size_t n = 0; n < read.extent.pixels(); ++n) view.depth.push_back(surface[4 * n + 3]);
  }
  return view;
}

}  // namespace inverse
