// SPDX-License-Identifier: LGPL-2.1-or-later
#include "relight.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/edit/replace_layer.hpp"

namespace inverse {
namespace {

using Apply = shaders::edit_relight_apply;
using Shadows = shaders::edit_relight_scene_shadows;
static_assert(4 * Shadows::kShareWords == kMaxLamps);
constexpr float kMinFieldOfView = 1, kMaxFieldOfView = 170;
constexpr float kRadian = 3.14159265F / 180;
constexpr float kMarkerShare = 1.F / 60;  // of the longer side of the frame

/// `value` within [low, high]; `low` for NaN.
float limited(float value, float low, float high) {
  return value > low ? std::min(value, high) : low;
}

bool is_white(const Lamp& lamp) {
  const uint32_t red = lamp.color >> 16 & 255;
  return red == (lamp.color >> 8 & 255) && red == (lamp.color & 255);
}

}  // namespace

Relight::Relight(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      planes_(device, extent),
      nothing_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      no_light_(gpu::Buffer::create(device, gpu::Element::vec4, 1)),
      no_share_(gpu::Buffer::create(device, gpu::Element::scalar, 1)),
      relief_(device, extent),
      apply_{{{device, {.color = false}}, {device, {.color = true}}}},
      share_(device),
      place_(device),
      shadows_(device),
      light_scene_(device) {}

void Relight::set_surface(std::shared_ptr<const SurfaceFile> file) {
  file_ = std::move(file);
  map_ = nullptr;
}

uint32_t Relight::prepare_surface(gpu::Commands& commands, const Layers& layers,
                                  const RelightParams& params) {
  using Surface = RelightParams::Surface;
  if (params.surface == Surface::flat) return Apply::kFlat;
  if (params.surface == Surface::shading || !file_) {
    const Role shape = layers[Role::model] ? Role::model : Role::intrinsic;
    relief_.record(commands, *layers[shape]);
    return Apply::kSlopes;
  }
  const float half = limited(params.field_of_view, kMinFieldOfView, kMaxFieldOfView) * kRadian / 2;
  const float focal = static_cast<float>(extent_.width) / 2 / std::tan(half);
  const float units = limited(params.depth_units, 1e-3F, 1e6F);
  if (!map_ || map_focal_ != focal || map_units_ != units) {
    map_ = gpu::make_table(device_, gpu::Element::vec4, file_->surface(extent_, focal, units));
    map_focal_ = focal, map_units_ = units;
  }
  if (file_->has_depth()) {
    view_.focal_length = focal;
    view_.plane_depth =
        params.plane_depth > 0 ? std::min(params.plane_depth, 1e4F) : file_->median() / units;
  }
  return Apply::kMap;
}

void Relight::record_scene(gpu::Commands& commands, const SeenScene& scene, int first, int count,
                           bool shadows) {
  const auto pixels = static_cast<uint32_t>(scene.extent.pixels());
  const auto halves = [](uint32_t n) {
    return (n + Shadows::kShareStep - 1) / Shadows::kShareStep;
  };
  const uint32_t shadow_pixels = halves(scene.extent.width) * halves(scene.extent.height);
  if (!placed_)
    placed_ = gpu::Buffer::create(device_, gpu::Element::vec4, Apply::kLampRows * kMaxLamps);
  if (!scene_light_ || scene_light_->count() != pixels || normals_->count() != shadow_pixels) {
    scene_light_ = gpu::Buffer::create(device_, gpu::Element::vec4, pixels);
    normals_ = gpu::Buffer::create(device_, gpu::Element::vec4, shadow_pixels);
    shares_ =
        gpu::Buffer::create(device_, gpu::Element::word, Shadows::kShareWords * shadow_pixels);
  }
  commands.dispatch(place_, {.lamps = lamps_, .pose = scene.pose->buffer, .placed = placed_},
                    {.lens = scene.lens.values(),
                     .size = extent_,
                     .view = scene.extent,
                     .count = static_cast<uint32_t>(first + count)},
                    static_cast<uint32_t>(first + count));
  commands.dispatch(shadows_,
                    {.lamps = placed_,
                     .surface = scene.surface->buffer,
                     .pose = scene.pose->buffer,
                     .table = scene.table,
                     .voxels = scene.voxels,
                     .normals = normals_,
                     .shares = shares_},
                    {.lens = scene.lens.values(),
                     .size = scene.extent,
                     .first = first,
                     .count = count,
                     .table_mask = scene.table_mask,
                     .voxel = scene.voxel,
                     .truncation = scene.truncation,
                     .shadows = shadows ? 1U : 0U},
                    shadow_pixels);
  commands.dispatch(
      light_scene_,
      {.lamps = placed_,
       .surface = scene.surface->buffer,
       .pose = scene.pose->buffer,
       .normals = normals_,
       .shares = shares_,
       .light = scene_light_},
      {.lens = scene.lens.values(), .size = scene.extent, .first = first, .count = count}, pixels);
  // Their pools write them again once nobody holds them, which is not before this is submitted.
  commands.keep(scene.surface);
  commands.keep(scene.pose);
}

void Relight::record(gpu::Commands& commands, Layers& layers, const RelightParams& params) {
  const float ambient = limited(params.ambient, 0, 1), strength = limited(params.strength, 0, 1e6F);
  std::vector<Lamp> lamps;
  for (const Lamp& lamp : params.lamps)
    if (lamps.size() < kMaxLamps && (strength * lamp.power > 0 || params.markers) &&
        (!lamp.room || layers.scene))
      lamps.push_back(lamp);
  const bool all_in_scene = params.surface == RelightParams::Surface::scene && layers.scene;
  const auto first_in_scene = std::stable_partition(
      lamps.begin(), lamps.end(), [&](const Lamp& l) { return !l.room && !all_in_scene; });
  const auto over_picture = static_cast<int>(first_in_scene - lamps.begin()),
             marks = static_cast<int>(lamps.size());
  if (lamps.empty() && ambient == 1) return reset();
  const bool matte = params.use_mask && layers[Role::mask];
  const PlanePtr& slope = layers[Role::slope];
  const bool light = layers.global();
  const bool color = light || slope || !std::all_of(lamps.begin(), lamps.end(), is_white);
  view_ = {.frame = extent_};
  const uint32_t surface =
      over_picture > 0 ? prepare_surface(commands, layers, params) : Apply::kFlat;
  if (all_in_scene)
    view_.plane_depth = params.plane_depth > 0 ? std::min(params.plane_depth, 1e4F) : kScenePlane;
  commands.write_table(lamps_, gpu::Element::vec4,
                       lamps.empty() ? std::vector<std::array<float, 4>>(1)
                                     : lamp_table(lamps, strength, view_, all_in_scene));
  const bool scene = over_picture < marks;
  if (scene)
    record_scene(commands, *layers.scene, over_picture, marks - over_picture, params.shadows);
  // Decided before anything here refers to the planes a second time.
  const PlanePtr edited = plane_to_edit(layers[Role::intrinsic], planes_);
  const PlanePtr lit = color ? plane_to_edit(layers[Role::light], planes_) : nullptr;
  const gpu::BufferPtr from = layers[Role::intrinsic]->buffer;
  const bool depth = view_.focal_length > 0;
  if (color && !kept_)
    kept_ = gpu::Buffer::create_by_rows(device_, gpu::Element::scalar, extent_.pixels());
  commands.dispatch_rows(
      apply_[color ? 1 : 0],
      {.intrinsic = from,
       .mask = matte ? layers[Role::mask]->buffer : from,
       .surface = surface == Apply::kMap      ? map_
                  : surface == Apply::kSlopes ? relief_.slopes()
                                              : nothing_,
       .lamps = scene ? placed_ : lamps_,
       .light = light ? layers[Role::light]->buffer : from,
       .slope = slope ? slope->buffer : nothing_,
       .scene_light = scene ? scene_light_ : nothing_,
       .edited = gpu::by_rows(gpu::aliased(edited->buffer)),
       .lit = color ? gpu::Out(gpu::by_rows(gpu::aliased(lit->buffer))) : gpu::Out(no_light_),
       .kept = color ? gpu::Out(gpu::by_rows(kept_)) : gpu::Out(no_share_)},
      {.size = layers.extent,
       .grid = surface == Apply::kSlopes ? relief_.grid() : Extent{1, 1},
       .view = scene ? layers.scene->extent : Extent{},
       .cells = surface == Apply::kSlopes ? 1 / static_cast<float>(relief_.factor()) : 1,
       .relief = limited(params.relief, -100, 100),
       .scale = depth ? 1 / view_.focal_length : 1 / static_cast<float>(extent_.width),
       .plane_depth = view_.plane_depth,
       .ambient = ambient,
       .marker = params.markers
                     ? std::max(static_cast<float>(std::max(extent_.width, extent_.height)) *
                                    kMarkerShare,
                                2.F)
                     : 0,
       .count = over_picture,
       .marks = marks,
       .surface = surface,
       .has_mask = matte ? 1U : 0U,
       .has_light = light ? 1U : 0U,
       .has_slope = slope ? 1U : 0U,
       .first_row = 0},
      {layers.extent.width, layers.extent.height, Apply::kRows});
  replace(commands, layers, Role::intrinsic, edited);
  if (!color) return;
  if (!light) {
    if (!white_) {
      white_ = planes_.acquire();
      constexpr uint32_t kOne = 0x3f800000;
      commands.fill(white_->buffer, kOne);
    }
    layers[Role::model_light] = white_;
  }
  replace(commands, layers, Role::light, lit);
  for (uint32_t n = 0; n < kIndirectPlanes && layers[indirect_role(n)]; ++n) {
    const Role role = indirect_role(n);
    const PlanePtr shares = plane_to_edit(layers[role], planes_);
    const gpu::BufferPtr before = layers[role]->buffer;
    commands.dispatch_rows(
        share_,
        {.shares = before, .kept = kept_, .edited = gpu::by_rows(gpu::aliased(shares->buffer))},
        {.size = layers.extent, .first_row = 0},
        {layers.extent.width, layers.extent.height, Apply::kRows});
    replace(commands, layers, role, shares);
  }
}

}  // namespace inverse
