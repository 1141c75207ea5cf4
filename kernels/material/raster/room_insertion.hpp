// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "kernels/camera/seen_scene.hpp"
#include "kernels/environment/light_beams.hpp"
#include "kernels/environment/lit_sphere.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/material_raster_cast.spv.hpp"
#include "kernels/material_raster_insert.spv.hpp"
#include "kernels/material_raster_probes.spv.hpp"
#include "rasterizer.hpp"

namespace inverse {

/// Inserts a mesh into the layers of a frame, where it stands in the remembered scene that the
/// frame sees (thesis 4.8 and 6.8; docs/reference/methods/materialclone.md): in perspective, behind
/// what is nearer, with shadows between it and the scene. Light comes from far away.
class RoomInsertion {
 public:
  struct Params {
    /// Below its center, at the height of its lowest corner: world axes, x right, y down, z
    /// forward, meters.
    std::array<float, 3> place{0, 0, 1};
    float size = 0.2F;          ///< diameter of the bounding sphere, meters
    float yaw = 0;              ///< as Insertion's; its front faces the camera of Pose{}
    float pitch = 0, roll = 0;  ///< as Insertion's
    float shadow = 0.8F;        ///< share of the blocked light that is missing, 0…1
    float softness = 0.1F;      ///< radius of the shadow's edge at the contact, radii
    bool operator==(const Params&) const = default;
  };
  /// How the light's map is placed.
  struct Light {
    float intensity = 1;
    float rotation = 0;  ///< LitSphere::View
    Pose seen_from;      ///< of the camera in whose axes the map is; Pose{}: panoramas of the world
  };

  RoomInsertion(std::shared_ptr<gpu::Device> device, Extent frame);

  /// Draws this mesh from the next `record` on; it has to be prepared (Mesh::prepare).
  void set_mesh(const Mesh& mesh);
  /// Records it into `layers`, which have the roles input, model, intrinsic and a scene, seen from
  /// `pose`. Planes that others hold are not written. `sphere` has its light. Parameters that are
  /// not finite become their defaults.
  void record(gpu::Commands& commands, Layers& layers, const Pose& pose, const Params& params,
              LitSphere& sphere, const Surface& surface, const Light& light);
  /// Invalidates what is kept: recorded work may not have run.
  void forget() { cast_key_.reset(); }
  /// The object's center, world.
  std::array<float, 3> center(const Params& params) const;
  /// How often the object and its shadow maps were drawn.
  uint64_t drawn() const { return drawn_; }
  uint64_t shadows() const { return shadows_; }

 private:
  using Vec3 = std::array<float, 3>;
  struct Window {
    int left = 0, top = 0, right = 0, bottom = 0;
    bool empty() const { return left >= right || top >= bottom; }
  };
  struct Cast {
    uint64_t light;
    std::array<Vec3, 3> turn;
    std::array<float, 4> seen_from;
    float rotation;
    bool operator==(const Cast&) const = default;
  };
  Window window(const SeenScene& scene, const Vec3& center, float radius) const;
  void cast(gpu::Commands& commands, const Cast& now, const LitSphere& sphere);

  std::shared_ptr<gpu::Device> device_;
  Extent frame_;
  PlanePool planes_;
  gpu::Program<shaders::material_raster_probes> probes_;
  gpu::Program<shaders::material_raster_cast> cast_;
  gpu::Program<shaders::material_raster_insert> insert_;
  std::vector<Mesh::Vec3> corners_;
  std::unique_ptr<Rasterizer> rasterizer_;
  Plane maps_;  // of the object, from the lights
  gpu::BufferPtr room_, reached_, hidden_, picture_, nothing_;
  std::vector<std::array<float, 4>> beams_;  // rows of room.glsl
  size_t lamps_ = 0;
  std::optional<Cast> cast_key_;
  uint64_t drawn_ = 0, shadows_ = 0;
};

}  // namespace inverse
