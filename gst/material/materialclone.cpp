// SPDX-License-Identifier: LGPL-2.1-or-later
// materialclone: an object of the material that was seen, drawn into the video (thesis 6.8, Figure
// 6.11) or into the remembered scene of its layers (4.8).
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clone_light.hpp"
#include "clone_room.hpp"
#include "gst/base/color.hpp"
#include "gst/base/filter.hpp"
#include "gst/inverse/inverse_material_meta.h"
#include "gst/material/mesh/mesh_process.hpp"
#include "kernels/environment/lit_sphere.hpp"
#include "kernels/material/raster/insertion.hpp"

namespace inverse {
namespace {

enum class MaterialFrom { stream, properties };

struct Params {
  std::string mesh, environment_location;
  MaterialFrom source = MaterialFrom::stream;
  uint32_t diffuse = 0xffbcbcbc;
  float specular = 0.2F, shininess = 64;
  Insertion::Params place;
  RoomInsertion::Params room;  // angles and shadow are those of place
  float spin = 0;
  float exposure = 0, rotation = 0;
  bool drag = false;
};

const PropertyTable<Params>& table() {
  using P = Params;
  static const PropertyTable<P> table{
      text<P>("mesh", &P::mesh,
              "OBJ, PLY or glTF file of the object's shape, at most 1000000 triangles; empty = a "
              "sphere",
              Mutable::ready),
      number<P>(
          "x", [](P& p) -> float& { return p.place.x; }, -1, 2,
          "Center of the object, fraction of the frame's width from its left edge"),
      number<P>(
          "y", [](P& p) -> float& { return p.place.y; }, -1, 2,
          "Center of the object, fraction of the frame's height from its top edge"),
      number<P>(
          "size", [](P& p) -> float& { return p.place.size; }, 0, 4,
          "Diameter of the sphere around the object, fraction of the frame's height"),
      number<P>(
          "room-x", [](P& p) -> float& { return p.room.place[0]; }, -1000, 1000,
          "In layers with a remembered scene: where the object stands, meters to the right"),
      number<P>(
          "room-y", [](P& p) -> float& { return p.room.place[1]; }, -1000, 1000,
          "The same of its lowest point, meters down"),
      number<P>(
          "room-z", [](P& p) -> float& { return p.room.place[2]; }, -1000, 1000,
          "The same, meters forward, along z of the scene's axes"),
      number<P>(
          "room-size", [](P& p) -> float& { return p.room.size; }, 0, 100,
          "The same: diameter of the sphere around the object, meters"),
      number<P>(
          "yaw", [](P& p) -> float& { return p.place.yaw; }, -360, 360,
          "Rotation about the vertical in degrees, positive to the right"),
      tuning(number<P>(
          "pitch", [](P& p) -> float& { return p.place.pitch; }, -360, 360,
          "Tilt of the object's top towards the camera (at yaw 0), degrees")),
      tuning(number<P>(
          "roll", [](P& p) -> float& { return p.place.roll; }, -360, 360,
          "Rotation in the picture plane (at yaw and pitch 0), degrees counterclockwise")),
      number<P>("spin", &P::spin, -3600, 3600,
                "Change of yaw in degrees per second of stream time"),
      tuning(number<P>(
          "elevation", [](P& p) -> float& { return p.place.elevation; }, 0, 90,
          "Angle at which the camera looks down on the ground, degrees; 0 = no visible shadow")),
      flag<P>(
          "drag", &P::drag,
          "Move the object with the mouse: navigation events set x and y, or in a scene room-x, "
          "room-y and room-z to the surface under the mouse"),
      text<P>("environment-location", &P::environment_location,
              "Radiance (.hdr) or OpenEXR panorama of the light; empty = the light that "
              "limematerial estimates",
              Mutable::ready),
      tuning(number<P>("environment-rotation", &P::rotation, -360, 360,
                       "Rotation of the light about the vertical in degrees, positive to the "
                       "right")),
      number<P>("exposure", &P::exposure, -10, 10,
                "Brightness of the light on the object, in stops"),
      tuning(number<P>(
          "shadow", [](P& p) -> float& { return p.place.shadow; }, 0, 1,
          "Darkness of the shadow on the ground; 0 = none, 1 = that of an overcast sky")),
      tuning(number<P>(
          "shadow-softness", [](P& p) -> float& { return p.place.softness; }, 0.05F, 1,
          "Softness of the shadow at the contact point, relative to the object's radius")),
      choice<P>("source", &P::source, "GstInverseMaterialFrom",
                {{static_cast<int>(MaterialFrom::stream), "stream",
                  "Material from limematerial; its last one while no object is found"},
                 {static_cast<int>(MaterialFrom::properties), "properties",
                  "diffuse-color, specular and shininess"}},
                "Source of the material"),
      color<P>("diffuse-color", &P::diffuse,
               "Diffuse albedo (0xAARRGGBB, sRGB) if the stream has none"),
      number<P>("specular", &P::specular, 0, 1, "Specular albedo, white, if the stream has none"),
      number<P>("shininess", &P::shininess, 2, 1024,
                "Exponent of highlights (Blinn-Phong) if the stream has none"),
  };
  return table;
}

/// That a software device draws in about a second.
constexpr size_t kManyTriangles = 100'000;

/// Side of the lit sphere's table in a scene, where it follows the camera.
constexpr uint32_t kRoomTable = 96;

/// Frames without an object before a warning: limematerial finds one some frames after it appears.
constexpr uint64_t kMinFrames = 10;
constexpr const char* kNoObject =
    "limematerial finds no object in the video, so diffuse-color, specular and shininess are "
    "drawn; "
    "show one object of one material, a third of the picture or larger, before an unlike "
    "background, or set source=properties";
constexpr const char* kEndedEarly =
    "the video ended before limematerial found an object in it, so diffuse-color, specular and "
    "shininess were drawn; repeat a still picture (imagefreeze num-buffers=10), or set "
    "source=properties";
constexpr const char* kLostObject =
    "limematerial finds its object no longer, so its last material is drawn; show one object of "
    "one material, a third of the picture or larger, or set source=properties";

class CloneElement final : public Filter {
 public:
  PropertyStore& parameters() override { return parameters_; }
  bool needs_square_pixels() const override { return true; }
  bool takes_view(std::string_view) const override { return true; }

  void start() override {
    const Params params = parameters_.snapshot();
    checked_stream_ = false;
    mesh_.reset();  // files may be others than at the last start
    warnings_.clear();
    std::string warning;
    mesh_ = params.mesh.empty() ? Mesh::sphere() : load_mesh(params.mesh, warning);
    if (!warning.empty()) warnings_.push_back(warning);
    light_.start(params.environment_location, warning);
    if (!warning.empty()) warnings_.push_back(warning);
    GST_CAT_INFO_OBJECT(log().category, log().object, "mesh: %s; light: %s",
                        params.mesh.empty() ? "a sphere" : params.mesh.c_str(),
                        params.environment_location.empty() ? "that of the stream"
                                                            : params.environment_location.c_str());
    seen_.reset();
    seen_from_.reset();
    last_ = {};
    warned_ = timeless_ = told_no_scene_ = told_lost_ = false;
    without_object_ = 0;
    reported_size_ = false;
  }

  void configure(const std::shared_ptr<gpu::Device>& device, Extent extent) override {
    sphere_.emplace(device);
    insertion_.emplace(device, extent);
    insertion_->set_mesh(*mesh_);
    if (device->is_cpu() && mesh_->triangles() > kManyTriangles &&
        !std::exchange(reported_size_, true))
      warnings_.push_back(parameters_.snapshot().mesh + " has " +
                          std::to_string(mesh_->triangles()) + " triangles, which \"" +
                          device->name() +
                          "\" draws in seconds whenever object, material or light change: simplify "
                          "it to some ten thousand");
    {
      std::lock_guard lock(mouse_mutex_);
      extent_ = extent;
      view_.reset();
    }
    light_.begin(*sphere_);
  }
  void release() override {
    insertion_.reset();
    room_.reset();
    sphere_.reset();
  }

  void reset() override {
    insertion_->forget();
    if (room_) room_->forget();
    sphere_->forget();
  }

  std::vector<Setting> navigate(const MouseEvent& event) override {
    const auto [kind, x, y] = event;
    std::vector<Setting> place;
    std::lock_guard lock(mouse_mutex_);
    held_ = parameters_.snapshot().drag && extent_.pixels() > 0 &&
            (held_ || kind == MouseEvent::Kind::press);
    if (held_ && view_) {
      if (const auto at = view_->place(x, y, extent_))
        place = {{"room-x", double{(*at)[0]}},
                 {"room-y", double{(*at)[1]}},
                 {"room-z", double{(*at)[2]}}};
    } else if (held_ && std::isfinite(x) && std::isfinite(y))
      place = {{"x", std::clamp(x / extent_.width, -1.0, 2.0)},
               {"y", std::clamp(y / extent_.height, -1.0, 2.0)}};
    if (kind == MouseEvent::Kind::release) held_ = false;
    return place;
  }

  void process(FrameContext& frame) override {
    const Params params = parameters_.snapshot();
    const GstMaterialMeta* meta = frame.in ? gst_buffer_get_material_meta(frame.in) : nullptr;
    for (std::string& warning : std::exchange(warnings_, {}))
      frame.warnings.push_back(std::move(warning));
    const std::optional<Pose> pose = frame.draw ? std::nullopt : camera(frame, params);
    const bool in_sight = frame.draw || pose;
    if (pose) follow_axes(frame.layers.scene->table, *pose);
    try {
      // Axes of what a lost camera sees are unknown.
      if (!in_sight)
        light_.ignore(meta);
      else if (light_.take(meta, *sphere_) && pose)
        seen_from_ = *pose;
    } catch (const Error& error) {  // of the stream's, not ours: the light before stays
      if (!warned_) frame.warnings.push_back(error.what());
      warned_ = true;
    }
    // limematerial attaches a meta to every frame, also if it finds no object.
    if (params.source == MaterialFrom::stream && frame.in &&
        !std::exchange(checked_stream_, true) && !meta)
      frame.warnings.emplace_back(
          "source=stream, but the frames bring no material: put limematerial before this element, "
          "and nothing that crops, pads or turns the picture between them; source=properties draws "
          "diffuse-color, specular and shininess");
    const Surface surface = material(meta, params);
    check_object(frame, meta, params);
    // Redraw for every change of properties, but not for estimates that hardly differ.
    if (!shown_ || !(surface_is_set_ ? surface == *shown_ : alike(surface, *shown_)))
      shown_ = surface;
    const LitSphere::View view{std::exp2(params.exposure),
                               params.rotation * std::numbers::pi_v<float> / 180};
    const Insertion::Params place = placed(frame, params);
    if (frame.draw) {
      sphere_->record(frame.commands, *shown_, view);
      frame.commands.stage("light");
      const PlanePtr& plane = frame.layers[Role::input];  // nobody else's: it goes no further
      insertion_->record(frame.commands, *plane, place, *sphere_);
      frame.picture = {plane};
    } else if (pose) {
      RoomInsertion::Params room = params.room;
      room.yaw = place.yaw, room.pitch = place.pitch, room.roll = place.roll;
      room.shadow = place.shadow, room.softness = place.softness;
      room_->insertion().record(frame.commands, frame.layers, *pose, room, *sphere_, *shown_,
                                {view.intensity, view.rotation, seen_from_.value_or(Pose{})});
    }
    drawn_[frame.number] = {*shown_, material_from_, light_.from(),
                            frame.draw ? insertion_->drawn()
                            : room_    ? room_->insertion().drawn()
                                       : 0,
                            frame.draw ? insertion_->shadows()
                            : room_    ? room_->insertion().shadows()
                                       : 0};
  }

  /// A stream too short for the warning of `check_object`.
  void ended() override {
    const uint64_t frames = std::exchange(without_object_, 0);
    if (frames > 0 && frames < kMinFrames && !seen_)
      throw Error(ErrorKind::unsupported, kEndedEarly);
  }

  void describe(GstStructure* stats, uint64_t number) const override {
    const Drawn& drawn = drawn_[number];
    const Surface& surface = drawn.surface;
    const auto real = [](float v) { return static_cast<gdouble>(v); };
    gst_structure_set(stats, "triangles", G_TYPE_UINT64,
                      static_cast<guint64>(mesh_ ? mesh_->triangles() : 0), "drawn", G_TYPE_UINT64,
                      drawn.drawn, "shadows", G_TYPE_UINT64, drawn.shadows, "material",
                      G_TYPE_STRING, drawn.material_from, "light", G_TYPE_STRING, drawn.light_from,
                      "diffuse-red", G_TYPE_DOUBLE, real(surface.diffuse[0]), "diffuse-green",
                      G_TYPE_DOUBLE, real(surface.diffuse[1]), "diffuse-blue", G_TYPE_DOUBLE,
                      real(surface.diffuse[2]), "specular", G_TYPE_DOUBLE, real(surface.specular),
                      "shininess", G_TYPE_DOUBLE, real(surface.shininess), nullptr);
  }

 private:
  /// What stats say of a frame.
  struct Drawn {
    Surface surface;
    const char *material_from = "", *light_from = "";
    uint64_t drawn = 0, shadows = 0;
  };

  /// Where the camera of layers is in their scene; empty: it is not known, which is warned of.
  std::optional<Pose> camera(FrameContext& frame, const Params& params) {
    std::optional<Pose> pose;
    std::optional<CloneView> view;
    if (frame.layers.scene) {
      if (!room_) {
        const auto device = sphere_->table().buffer->device();
        room_.emplace(device, frame.layers.extent, *mesh_);
        // Its table is made anew whenever the camera moves.
        sphere_.emplace(device, kRoomTable);
        light_.begin(*sphere_);
      }
      if ((view = room_->see(frame, params.drag))) pose = view->pose;
      if (!pose && !std::exchange(told_lost_, true))
        frame.warnings.emplace_back(
            "the camera is not found in the remembered scene, so the object is not drawn until it "
            "is; show what it has seen before");
    } else if (!std::exchange(told_no_scene_, true)) {
      frame.warnings.emplace_back(
          "the object stands in a remembered scene, but layers come without one, so it is not "
          "drawn; use a source with depth and a decomposer with scene::remember=true, or put this "
          "element behind intrinsiccompose to draw over the picture");
    }
    std::lock_guard lock(mouse_mutex_);
    view_ = std::move(view);
    return pose;
  }

  /// Once the scene was forgotten it begins with other axes, in which the stream's light stays
  /// where the camera saw it.
  void follow_axes(const gpu::BufferPtr& scene, const Pose& camera) {
    if (last_.scene && last_.scene != scene && seen_from_)
      seen_from_ = turned_along(*seen_from_, last_.camera, camera);
    last_ = {scene, camera};
  }

  /// Where the object is in this frame, which spin turns.
  Insertion::Params placed(FrameContext& frame, const Params& params) {
    Insertion::Params place = params.place;
    if (params.spin == 0) return place;
    if (GST_CLOCK_TIME_IS_VALID(frame.time))
      place.yaw = static_cast<float>(std::fmod(
          place.yaw + params.spin * (static_cast<double>(frame.time) / GST_SECOND), 360.0));
    else if (!std::exchange(timeless_, true))
      frame.warnings.emplace_back(
          "spin turns with stream time, and the frames have none: give them timestamps in a "
          "segment of format time (appsrc: format=time)");
    return place;
  }

  /// Warns, once for each time, of a stream in which limematerial finds no object or finds it no
  /// longer.
  void check_object(FrameContext& frame, const GstMaterialMeta* meta, const Params& params) {
    if (!meta || meta->found || params.source != MaterialFrom::stream)
      without_object_ = 0;
    else if (++without_object_ == kMinFrames)
      frame.warnings.emplace_back(seen_ ? kLostObject : kNoObject);
  }

  /// The material of this frame.
  Surface material(const GstMaterialMeta* meta, const Params& params) {
    const bool measured = meta && meta->found && meta->averaged > 0;
    if (measured) {
      seen_ = Surface{};
      std::copy_n(meta->diffuse, 3, seen_->diffuse.begin());
      seen_->specular = meta->specular;
      seen_->shininess = meta->shininess;
    }
    surface_is_set_ = params.source == MaterialFrom::properties || !seen_;
    material_from_ = surface_is_set_ ? "properties" : measured ? "stream" : "held";
    if (!surface_is_set_) return *seen_;
    return {linear_color(params.diffuse), params.specular, params.shininess};
  }

  Parameters<Params> parameters_{table()};
  std::optional<Mesh> mesh_;
  CloneLight light_;
  std::optional<Surface> seen_;  // the last surface of the stream
  std::optional<Surface> shown_;
  std::vector<std::string> warnings_;  // of the files, posted with the first frame
  bool reported_size_ = false;         // that the mesh is large
  bool warned_ = false;                // of light that is none
  bool timeless_ = false;              // reported that frames have no time
  bool told_no_scene_ = false, told_lost_ = false;
  std::optional<Pose> seen_from_;  // the camera of the frame that brought the stream's light
  struct Last {
    gpu::BufferPtr scene;  // one of its buffers
    Pose camera;
  };
  Last last_;                    // frame that found its camera
  bool checked_stream_ = false;  // whether the stream brings a material, once
  uint64_t without_object_ = 0;  // frames since limematerial last found an object
  std::mutex mouse_mutex_;
  Extent extent_;                  // of frames
  std::optional<CloneView> view_;  // of layers
  bool held_ = false;              // the mouse's button is down
  bool surface_is_set_ = false;    // by properties
  const char* material_from_ = "properties";
  std::optional<LitSphere> sphere_;
  std::optional<Insertion> insertion_;
  std::optional<CloneRoom> room_;  // made for the first layers with a scene
  gpu::FrameRing<Drawn> drawn_;    // by the frame's number
};

}  // namespace

extern const ElementInfo kMaterialClone;
const ElementInfo kMaterialClone{
    .factory = "materialclone",
    .type_name = "GstMaterialClone",
    .long_name = "Live material cloning",
    .klass = "Filter/Effect/Video",
    .description =
        "Draws an object into the video or into a remembered scene, in "
        "the material and light that limematerial estimates, with shadows",
    .sink = Flow::pixels_or_layers,
    .src = Flow::pixels_or_layers,
    .layers = kAnyLayers,
    .needs = "intrinsicdecomp",
    .create = [] { return std::unique_ptr<Filter>(new CloneElement); },
    .navigation = true,
    .accepts = kAnyLayers,
    .plain_caps = same_content,
};

}  // namespace inverse
