// SPDX-License-Identifier: LGPL-2.1-or-later
#include "room_insertion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "kernels/edit/replace_layer.hpp"
#include "turn.hpp"

namespace inverse {
namespace {

using Row = std::array<float, 4>;
using Eigen::Matrix3f, Eigen::Quaternionf, Eigen::Vector3f;
using Room = shaders::material_raster_cast;

constexpr float kNearest = 0.02F;  // meters, as in place.comp
constexpr float kMinAlbedo = 0.02F;

/// Between axes of the world, or of a camera with z forward, and those with y up and z back.
const Quaternionf kFlip(0, 1, 0, 0);

Quaternionf rotation_of(const Pose& pose) {
  const auto& [x, y, z, w] = pose.rotation;
  return Quaternionf(w, x, y, z).normalized();
}
Vector3f vector(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }
std::array<float, 3> array(const Vector3f& v) { return {v.x(), v.y(), v.z()}; }
Row row(const Vector3f& v, float w) { return {v.x(), v.y(), v.z(), w}; }
Row row(const Quaternionf& q) { return {q.x(), q.y(), q.z(), q.w()}; }

Turn rows_of(const Matrix3f& m) {
  Turn turn;
  for (int i = 0; i < 3; ++i) turn[size_t(i)] = array(m.row(i).transpose());
  return turn;
}
Matrix3f matrix(const Turn& turn) {
  Matrix3f m;
  for (int i = 0; i < 3; ++i) m.row(i) = vector(turn[size_t(i)]).transpose();
  return m;
}

Turn turn_of(const RoomInsertion::Params& p) {
  return about_y(p.yaw) * nod(p.pitch) * about_z(p.roll);
}

RoomInsertion::Params finite(RoomInsertion::Params p) {
  const RoomInsertion::Params defaults;
  for (float RoomInsertion::Params::*field :
       {&RoomInsertion::Params::size, &RoomInsertion::Params::yaw, &RoomInsertion::Params::pitch,
        &RoomInsertion::Params::roll, &RoomInsertion::Params::shadow,
        &RoomInsertion::Params::softness})
    if (!std::isfinite(p.*field)) p.*field = defaults.*field;
  for (size_t c = 0; c < 3; ++c)
    p.place[c] =
        std::isfinite(p.place[c]) ? std::clamp(p.place[c], -1000.0F, 1000.0F) : defaults.place[c];
  p.size = std::clamp(p.size, 0.0F, 100.0F);
  p.shadow = std::clamp(p.shadow, 0.0F, 1.0F);
  p.softness = std::clamp(p.softness, 0.0F, 1.0F);
  return p;
}

/// Axes of which the third one is this unit vector, and the second as far up as can be.
Matrix3f axes(const Vector3f& forward) {
  const Vector3f up(0, -1, 0);
  Vector3f right = up.cross(forward);
  right = right.norm() > 1e-3F ? right.normalized() : Vector3f(1, 0, 0);
  Matrix3f result;
  result << right, forward.cross(right).normalized(), forward;
  return result;
}

}  // namespace

RoomInsertion::RoomInsertion(std::shared_ptr<gpu::Device> device, Extent frame)
    : device_(std::move(device)),
      frame_(frame),
      planes_(device_, frame),
      probes_(device_),
      cast_(device_),
      insert_(device_),
      maps_{{Room::kMapSide * Room::kMapColumns, 2 * Room::kMapSide * Room::kMapRows}, nullptr},
      reached_(gpu::Buffer::create(device_, gpu::Element::vec4,
                                   uint64_t{2} * Room::kProbes * Room::kProbes * Room::kProbes)),
      nothing_(gpu::Buffer::create(device_, gpu::Element::vec4, 1)) {
  maps_.buffer = gpu::Buffer::create(device_, gpu::Element::vec4, maps_.extent.pixels());
}

void RoomInsertion::set_mesh(const Mesh& mesh) {
  rasterizer_ = std::make_unique<Rasterizer>(device_, mesh);
  corners_ = mesh.positions;
  forget();
}

std::array<float, 3> RoomInsertion::center(const Params& asked) const {
  const Params params = finite(asked);
  const Turn turn = turn_of(params);
  float lowest = std::numeric_limits<float>::max();
  for (const Mesh::Vec3& p : corners_)
    lowest = std::min(lowest, turn[1][0] * p[0] + turn[1][1] * p[1] + turn[1][2] * p[2]);
  // Up is -y.
  return {params.place[0], params.place[1] + lowest * params.size / 2, params.place[2]};
}

RoomInsertion::Window RoomInsertion::window(const SeenScene& scene, const Vec3& center,
                                            float radius) const {
  const float near = center[2] - radius, far = center[2] + radius;
  if (far < kNearest) return {};
  const auto bounds = [&](float f, float c, uint32_t view, uint32_t frame, float at) {
    const auto size = static_cast<float>(frame), scale = size / static_cast<float>(view);
    std::pair<float, float> range{0, size};
    // A ball around the camera may be seen anywhere.
    if (near > kNearest) {
      const auto pixel = [&](float x, float z) { return (f * x / z + c + 0.5F) * scale; };
      range = {std::min(pixel(at - radius, near), pixel(at - radius, far)) - 1,
               std::max(pixel(at + radius, near), pixel(at + radius, far)) + 1};
    }
    return std::pair{static_cast<int>(std::clamp(std::floor(range.first), 0.0F, size)),
                     static_cast<int>(std::clamp(std::ceil(range.second), 0.0F, size))};
  };
  const auto [left, right] =
      bounds(scene.lens.fx, scene.lens.cx, scene.extent.width, frame_.width, center[0]);
  const auto [top, bottom] =
      bounds(scene.lens.fy, scene.lens.cy, scene.extent.height, frame_.height, center[1]);
  return {left, top, right, bottom};
}

void RoomInsertion::cast(gpu::Commands& commands, const Cast& now, const LitSphere& sphere) {
  if (cast_key_ == now) return;
  cast_key_.reset();  // until recorded
  ++shadows_;
  const LightBeams light = divided_light(sphere.cells());
  const Quaternionf map_to_world =
      Quaternionf(now.seen_from[3], now.seen_from[0], now.seen_from[1], now.seen_from[2])
          .normalized() *
      kFlip * Quaternionf(Eigen::AngleAxisf(now.rotation, Vector3f::UnitY()));
  const Matrix3f object = kFlip.toRotationMatrix() * matrix(now.turn);  // to the world
  beams_.clear();
  lamps_ = light.lamps;
  for (size_t k = 0; k < light.beams.size(); ++k) {
    const Vector3f mean = map_to_world * vector(light.beams[k].mean);
    // Directions within an angle a have a mean of length (1 + cos a) / 2 and a solid angle of
    // 2 pi (1 - cos a), which is that of a disk of this radius at a distance of 1, but for its
    // tilt.
    const float length = mean.norm(), radius = 2 * std::sqrt(std::max(1 - length, 0.0F));
    const Matrix3f own = axes(length > 0 ? Vector3f(mean.normalized()) : Vector3f(0, -1, 0));
    beams_.push_back(row(mean, light.beams[k].flux));
    beams_.push_back(row(own.col(0), radius));
    beams_.push_back(row(own.col(1), 0));
    beams_.push_back(row(own.col(2), 0));
    MeshView view;
    view.turn = rows_of(own.transpose() * object);
    view.scale = Room::kMapScale;
    view.x = view.y = Room::kMapSide / 2.0F;
    const auto column = static_cast<uint32_t>(k) % Room::kMapColumns,
               line = static_cast<uint32_t>(k) / Room::kMapColumns;
    for (const uint32_t side : {0, 1}) {
      rasterizer_->depth(commands, view, maps_,
                         {column * Room::kMapSide, (line + side * Room::kMapRows) * Room::kMapSide},
                         {Room::kMapSide, Room::kMapSide});
      for (float& v : view.turn[2]) v = -v;
    }
  }
  cast_key_ = now;
  commands.stage("shadow");
}

void RoomInsertion::record(gpu::Commands& commands, Layers& layers, const Pose& pose,
                           const Params& asked, LitSphere& sphere, const Surface& surface,
                           const Light& light) {
  if (!rasterizer_) throw Error(ErrorKind::internal, "there is no mesh to insert");
  if (!layers.scene || !layers[Role::input] || !layers[Role::model] || !layers[Role::intrinsic])
    throw Error(ErrorKind::internal, "layers without a scene to insert into");
  if (layers.extent != frame_) throw Error(ErrorKind::internal, "layers of another size");
  const Params params = finite(asked);
  const SeenScene& scene = *layers.scene;
  const float radius = params.size / 2;
  if (!(radius > 0)) return;

  const Quaternionf camera = rotation_of(pose), map = rotation_of(light.seen_from) * kFlip;
  const Vector3f middle = vector(center(params)),
                 place(pose.place[0], pose.place[1], pose.place[2]);
  const Vector3f seen = camera.conjugate() * (middle - place);
  const Vector3f back = seen.norm() > 1e-6F ? Vector3f((place - middle).normalized())
                                            : Vector3f(camera * Vector3f(0, 0, -1));
  const Quaternionf lit(axes(back));  // the lit sphere's table looks from the object to the camera
  const float rotation = std::isfinite(light.rotation) ? light.rotation : 0;
  sphere.record(commands, surface,
                {light.intensity, rotation, row(Quaternionf(map.conjugate() * lit))});
  commands.stage("light");

  const Turn turn = turn_of(params);
  cast(commands, {sphere.lights(), turn, row(rotation_of(light.seen_from)), rotation}, sphere);
  const Window window = this->window(scene, array(seen), radius);
  const Vector3f frame_pixels(
      static_cast<float>(frame_.width) / static_cast<float>(scene.extent.width),
      static_cast<float>(frame_.height) / static_cast<float>(scene.extent.height), 0);
  const size_t beams = beams_.size() / Room::kBeamRows;
  std::vector<Row> rows{
      row(camera),
      row(place, 0),
      row(Quaternionf(lit.conjugate() * camera * kFlip)),
      row(middle, radius),
      {static_cast<float>(window.left), static_cast<float>(window.top), 1 / frame_pixels.x(),
       1 / frame_pixels.y()},
      {static_cast<float>(scene.extent.width), static_cast<float>(scene.extent.height),
       static_cast<float>(beams), static_cast<float>(lamps_)}};
  rows.insert(rows.end(), beams_.begin(), beams_.end());
  commands.write_table(room_, gpu::Element::vec4, rows);

  const Extent extent{static_cast<uint32_t>(std::max(window.right - window.left, 0)),
                      static_cast<uint32_t>(std::max(window.bottom - window.top, 0))};
  const bool drawn = !window.empty();
  if (drawn) {
    commands.dispatch(
        probes_, {.room = room_, .table = scene.table, .voxels = scene.voxels, .reached = reached_},
        {.table_mask = scene.table_mask, .voxel = scene.voxel, .truncation = scene.truncation},
        {static_cast<uint32_t>(reached_->count() / 2)});
    if (!picture_ || picture_->count() < extent.pixels())
      picture_ = gpu::Buffer::create(device_, gpu::Element::vec4, extent.pixels());
    MeshView view;
    view.turn = rows_of(kFlip.toRotationMatrix() * camera.conjugate().toRotationMatrix() *
                        kFlip.toRotationMatrix() * matrix(turn));
    view.scale = radius;
    const Vector3f origin = kFlip * seen;
    view.x = origin.x(), view.y = origin.y(), view.z = origin.z();
    view.lens = {scene.lens.fx * frame_pixels.x(), scene.lens.fy * frame_pixels.y(),
                 (scene.lens.cx + 0.5F) * frame_pixels.x() - static_cast<float>(window.left),
                 (scene.lens.cy + 0.5F) * frame_pixels.y() - static_cast<float>(window.top)};
    rasterizer_->draw_in_room(commands, view, sphere.table(),
                              {room_, scene.surface->buffer, reached_}, {extent, picture_});
    ++drawn_;
    commands.stage("draw");
  }

  const auto along = [](uint32_t n) { return (n + Room::kCastStep - 1) / Room::kCastStep; };
  const uint32_t pixels = along(scene.extent.width) * along(scene.extent.height);
  if (!hidden_ || hidden_->count() != pixels)
    hidden_ = gpu::Buffer::create(device_, gpu::Element::vec4, pixels);
  commands.dispatch(cast_,
                    {.room = room_,
                     .surface = scene.surface->buffer,
                     .maps = maps_.buffer,
                     .table = scene.table,
                     .voxels = scene.voxels,
                     .hidden = hidden_},
                    {.lens = scene.lens.values(),
                     .size = scene.extent,
                     .table_mask = scene.table_mask,
                     .voxel = scene.voxel,
                     .truncation = scene.truncation,
                     .strength = params.shadow,
                     .softness = params.softness},
                    pixels);
  commands.stage("cast");

  // Decided before anything here refers to the planes a second time.
  const PlanePtr frame = plane_to_edit(layers[Role::input], planes_),
                 model = plane_to_edit(layers[Role::model], planes_),
                 edited = plane_to_edit(layers[Role::intrinsic], planes_);
  const bool colored = layers.global();
  const PlanePtr& slope = layers[Role::slope];
  const gpu::BufferPtr from = layers[Role::intrinsic]->buffer;
  const float albedo = (surface.diffuse[0] + surface.diffuse[1] + surface.diffuse[2]) / 3;
  commands.dispatch_rows(
      insert_,
      {.frame = layers[Role::input]->buffer,
       .model = layers[Role::model]->buffer,
       .intrinsic = from,
       .model_light = colored ? layers[Role::model_light]->buffer : nothing_,
       .light = colored ? layers[Role::light]->buffer : nothing_,
       .slope = slope ? slope->buffer : nothing_,
       .picture = drawn ? picture_ : nothing_,
       .hidden = hidden_,
       .inserted_frame = gpu::by_rows(gpu::aliased(frame->buffer)),
       .inserted_model = gpu::by_rows(gpu::aliased(model->buffer)),
       .inserted = gpu::by_rows(gpu::aliased(edited->buffer))},
      {.size = frame_,
       .view = scene.extent,
       .window = {window.left, window.top},
       .window_size = {static_cast<int>(extent.width), static_cast<int>(extent.height)},
       .step = Room::kCastStep,
       .albedo = albedo > kMinAlbedo ? albedo : kMinAlbedo,
       .has_light = colored ? 1U : 0U,
       .has_slope = slope ? 1U : 0U,
       .first_row = 0},
      {frame_.width, frame_.height, shaders::material_raster_insert::kRows});
  // Its pool writes it again once nobody holds it, which is not before this is submitted.
  commands.keep(scene.surface);
  replace(commands, layers, Role::input, frame);
  replace(commands, layers, Role::model, model);
  replace(commands, layers, Role::intrinsic, edited);
  commands.stage("insert");
}

}  // namespace inverse
