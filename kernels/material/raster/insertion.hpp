// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>

#include "kernels/environment/lit_sphere.hpp"
#include "kernels/material_raster_blend.spv.hpp"
#include "kernels/material_raster_occlude.spv.hpp"
#include "rasterizer.hpp"

namespace inverse {

/// Inserts a mesh into an image (thesis 6.8): lit by a lit sphere's table, standing on ground seen
/// from slightly above, with a shadow. The camera is far away, as for the lit sphere.
///
/// The shadow is the share of a uniform sky that the object's underside hides from a point of the
/// ground: the sum over patches dA at height h and distance r along the ground of h² dA / (pi (r² +
/// h²)²), the form factor of two parallel patches.
class Insertion {
 public:
  struct Params {
    float x = 0.5F, y = 0.5F;  ///< center of the object, fractions of the frame
    float size = 0.5F;         ///< diameter of the bounding sphere, fraction of the frame's height
    float yaw = 0;          ///< about the vertical, degrees; positive turns its front to the right
    float pitch = 0;        ///< its top towards the camera, degrees; before yaw
    float roll = 0;         ///< counterclockwise, degrees; before pitch
    float elevation = 20;   ///< of the camera above the horizon, degrees; 0: no visible shadow
    float shadow = 0.8F;    ///< opacity: 0 none … 1 all light that the object blocks
    float softness = 0.1F;  ///< of the shadow: additional height of the object above the ground,
                            ///< radii
    bool operator==(const Params&) const = default;
  };

  Insertion(std::shared_ptr<gpu::Device> device, Extent frame);

  /// Draws this mesh from the next `record` on; it has to be prepared (Mesh::prepare).
  void set_mesh(const Mesh& mesh);
  /// Records drawing into `frame`, in place: linear RGB and alpha, not premultiplied. The object's
  /// image is kept and redrawn only if object, placement or table (`light.version()`) changed.
  /// Changes no pixel outside of the rectangle around object and shadow. Parameters that are not
  /// finite become their defaults.
  void record(gpu::Commands& commands, const Plane& frame, const Params& params,
              const LitSphere& light);
  /// Invalidates kept images: recorded work may not have run.
  void forget();
  /// Number of redraws of the object and of its shadow.
  uint64_t drawn() const { return drawn_; }
  uint64_t shadows() const { return shadows_; }

 private:
  struct Rectangle {
    int left, top, right, bottom;
    bool empty() const { return left >= right || top >= bottom; }
    bool operator==(const Rectangle&) const = default;
  };
  /// Parameters on which the object's image depends.
  struct Drawn {
    MeshView view;
    Rectangle window;
    uint64_t table;
    bool operator==(const Drawn&) const = default;
  };
  struct Shaded {
    float pitch, roll, softness;
    bool operator==(const Shaded&) const = default;
  };
  Rectangle clipped(float left, float top, float right, float bottom) const;
  void draw(gpu::Commands& commands, const MeshView& view, const Rectangle& window,
            const LitSphere& light);
  void cast_shadow(gpu::Commands& commands, const Params& params);

  std::shared_ptr<gpu::Device> device_;
  Extent frame_;
  gpu::Program<shaders::material_raster_occlude> occlude_;
  gpu::Program<shaders::material_raster_blend> blend_;
  std::vector<Mesh::Vec3> corners_;
  std::unique_ptr<Rasterizer> rasterizer_;
  gpu::BufferPtr picture_;
  Plane heights_, occlusion_;
  float ground_ = 0;  // height of the lowest corner
  std::optional<Drawn> image_key_;
  std::optional<Shaded> shadow_key_;
  uint64_t drawn_ = 0, shadows_ = 0;
};

}  // namespace inverse
