// SPDX-License-Identifier: LGPL-2.1-or-later
#include "insertion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "turn.hpp"

namespace inverse {
namespace {

using Row = MeshView::Row;

// The grids on the ground: pixels per unit and per side.
using Ground = shaders::material_raster_occlude;
constexpr auto kPerUnit = static_cast<uint32_t>(Ground::kPerUnit);
constexpr uint32_t kHeights = Ground::kHeights, kOcclusion = Ground::kOcclusion;
constexpr float kReach = Ground::kReach;  // of the shadow, in radii

Row negative(const Row& row) { return {-row[0], -row[1], -row[2]}; }

Insertion::Params finite(Insertion::Params p) {
  const Insertion::Params defaults;
  for (float Insertion::Params::*field :
       {&Insertion::Params::x, &Insertion::Params::y, &Insertion::Params::size,
        &Insertion::Params::yaw, &Insertion::Params::pitch, &Insertion::Params::roll,
        &Insertion::Params::elevation, &Insertion::Params::shadow, &Insertion::Params::softness})
    if (!std::isfinite(p.*field)) p.*field = defaults.*field;
  p.x = std::clamp(p.x, -10.0F, 10.0F);
  p.y = std::clamp(p.y, -10.0F, 10.0F);
  p.size = std::clamp(p.size, 0.0F, 4.0F);
  p.elevation = std::clamp(p.elevation, 0.0F, 90.0F);
  p.shadow = std::clamp(p.shadow, 0.0F, 1.0F);
  p.softness = std::clamp(p.softness, 0.0F, 1.0F);
  return p;
}

Plane grid(const std::shared_ptr<gpu::Device>& device, uint32_t side) {
  return {{side, side}, gpu::Buffer::create(device, gpu::Element::vec4, uint64_t{side} * side)};
}

}  // namespace

Insertion::Insertion(std::shared_ptr<gpu::Device> device, Extent frame)
    : device_(std::move(device)),
      frame_(frame),
      occlude_(device_),
      blend_(device_),
      heights_(grid(device_, kHeights)),
      occlusion_(grid(device_, kOcclusion)) {}

void Insertion::set_mesh(const Mesh& mesh) {
  rasterizer_ = std::make_unique<Rasterizer>(device_, mesh);
  corners_ = mesh.positions;
  forget();
}

void Insertion::forget() {
  image_key_.reset();
  shadow_key_.reset();
}

Insertion::Rectangle Insertion::clipped(float left, float top, float right, float bottom) const {
  const auto within = [](float value, uint32_t size) {
    return static_cast<int>(std::clamp(value, 0.0F, static_cast<float>(size)));
  };
  return {within(std::floor(left), frame_.width), within(std::floor(top), frame_.height),
          within(std::ceil(right), frame_.width), within(std::ceil(bottom), frame_.height)};
}

void Insertion::draw(gpu::Commands& commands, const MeshView& view, const Rectangle& window,
                     const LitSphere& light) {
  const Drawn now{view, window, light.version()};
  if (image_key_ == now) return;
  image_key_.reset();  // until recorded
  ++drawn_;
  const Extent extent{static_cast<uint32_t>(window.right - window.left),
                      static_cast<uint32_t>(window.bottom - window.top)};
  if (!picture_ || picture_->count() < extent.pixels())
    picture_ = gpu::Buffer::create(device_, gpu::Element::vec4, extent.pixels());
  MeshView within = view;
  within.x -= static_cast<float>(window.left);
  within.y -= static_cast<float>(window.top);
  rasterizer_->draw(commands, within, light.table(), {extent, picture_});
  image_key_ = now;
  commands.stage("draw");
}

void Insertion::cast_shadow(gpu::Commands& commands, const Params& params) {
  const Shaded now{params.pitch, params.roll, params.softness};
  if (shadow_key_ == now) return;
  shadow_key_.reset();  // until recorded
  ++shadows_;
  const Turn turn = nod(params.pitch) * about_z(params.roll);
  ground_ = std::numeric_limits<float>::max();
  for (const Mesh::Vec3& p : corners_)
    ground_ = std::min(ground_, turn[1][0] * p[0] + turn[1][1] * p[1] + turn[1][2] * p[2]);
  // Seen from below: right is right, and the side near the camera is at the bottom.
  MeshView below;
  below.turn = {turn[0], negative(turn[2]), negative(turn[1])};
  below.scale = kPerUnit;
  below.x = below.y = kHeights / 2.0F;
  rasterizer_->depth(commands, below, heights_);
  commands.dispatch(occlude_, {.heights = heights_.buffer, .occlusion = occlusion_.buffer},
                    {.ground = ground_, .soft = params.softness}, {kOcclusion * kOcclusion});
  shadow_key_ = now;
  commands.stage("shadow");
}

void Insertion::record(gpu::Commands& commands, const Plane& frame, const Params& asked,
                       const LitSphere& light) {
  if (!rasterizer_) throw Error(ErrorKind::internal, "there is no mesh to insert");
  if (frame.extent != frame_) throw Error(ErrorKind::internal, "a frame of another size");
  const Params params = finite(asked);
  const float radius = 0.5F * params.size * static_cast<float>(frame_.height);
  if (!(radius > 0)) return;
  MeshView view;
  view.turn =
      nod(params.elevation) * about_y(params.yaw) * nod(params.pitch) * about_z(params.roll);
  view.scale = radius;
  view.x = params.x * static_cast<float>(frame_.width);
  view.y = params.y * static_cast<float>(frame_.height);

  const float sine = std::sin(params.elevation * kRadian);
  const bool shaded = params.shadow > 0 && sine > 0.02F;
  if (shaded) cast_shadow(commands, params);
  const float ground = ground_ * std::cos(params.elevation * kRadian);  // as the camera sees it
  Rectangle window =
      clipped(view.x - radius - 1, view.y - radius - 1, view.x + radius + 1, view.y + radius + 1);
  Rectangle all = window;
  if (shaded) {
    const Rectangle shadow =
        clipped(view.x - kReach * radius, view.y - radius * (ground + kReach * sine),
                view.x + kReach * radius, view.y - radius * (ground - kReach * sine));
    if (window.empty())
      all = shadow;
    else if (!shadow.empty())
      all = {std::min(all.left, shadow.left), std::min(all.top, shadow.top),
             std::max(all.right, shadow.right), std::max(all.bottom, shadow.bottom)};
  }
  if (all.empty()) return;
  if (window.empty()) window = {0, 0, 0, 0};
  if (!window.empty()) draw(commands, view, window, light);
  const gpu::BufferPtr& picture = window.empty() ? occlusion_.buffer : picture_;
  const float yaw = params.yaw * kRadian;
  commands.dispatch(
      blend_, {.picture = picture, .occlusion = occlusion_.buffer, .frame = frame.buffer},
      {.origin = {all.left, all.top},
       .size = {all.right - all.left, all.bottom - all.top},
       .window = {window.left, window.top},
       .window_size = {window.right - window.left, window.bottom - window.top},
       .stride = frame_.width,
       .center_x = view.x,
       .center_y = view.y,
       .radius = radius,
       .ground = ground,
       .sine = shaded ? sine : 1,
       .turn_x = std::cos(yaw),
       .turn_y = std::sin(yaw),
       .strength = shaded ? params.shadow : 0},
      {static_cast<uint32_t>(all.right - all.left), static_cast<uint32_t>(all.bottom - all.top)});
  commands.stage("blend");
}

}  // namespace inverse
