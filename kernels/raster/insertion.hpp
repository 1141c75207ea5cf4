#pragma once
#include <memory>
#include <optional>

#include "kernels/environment/lit_sphere.hpp"
#include "kernels/raster_blend.spv.hpp"
#include "kernels/raster_occlude.spv.hpp"
#include "rasterizer.hpp"

namespace inverse {

/// Puts a mesh into a picture (thesis 6.8): lit by a lit sphere's table, standing on ground that is
/// seen from a little above, and darkening it by the light that it keeps away. The camera is far
/// away, as the lit sphere has it.
///
/// The shadow is what of a sky of even light the underside of the object hides from a point of the
/// ground: the sum over patches dA of it, at height h and distance r along the ground, of
/// h² dA / (pi (r² + h²)²), the form factor of two patches that face each other.
class Insertion {
 public:
  struct Params {
    float x = 0.5F, y = 0.5F;  ///< the object's center, fractions of the picture
    float size = 0.5F;         ///< diameter of the sphere around the object, fraction of its height
    float yaw = 0;             ///< about the vertical, degrees; positive: its front to the right
    float pitch = 0;           ///< its top towards the camera, degrees; before yaw
    float roll = 0;            ///< counterclockwise, degrees; before pitch
    float elevation = 20;      ///< of the camera above the horizon, degrees; 0: no shadow is seen
    float shadow = 0.8F;       ///< 0 none … 1 all light that the object keeps away
    float softness = 0.1F;     ///< of the shadow: how far the object counts as above the ground,
                               ///< in radii
    bool operator==(const Params&) const = default;
  };

  Insertion(std::shared_ptr<gpu::Device> device, Extent frame);

  /// Draws this one from the next `record` on; prepared (Mesh::prepare).
  void set_mesh(const Mesh& mesh);
  /// Records drawing into `frame`, in place: linear RGB and alpha, not premultiplied. What shows
  /// the object is kept, and drawn again only where object, place or table (`light.version()`)
  /// changed. Touches nothing outside of the rectangle around object and shadow. Parameters that
  /// are not finite count as their defaults.
  void record(gpu::Commands& commands, const Plane& frame, const Params& params,
              const LitSphere& light);
  /// What was recorded may not have been computed: the next picture is drawn anew.
  void forget();
  /// How often the object and its shadow were drawn anew.
  uint64_t drawn() const { return drawn_; }
  uint64_t shadows() const { return shadows_; }

 private:
  struct Rectangle {
    int left, top, right, bottom;
    bool empty() const { return left >= right || top >= bottom; }
    bool operator==(const Rectangle&) const = default;
  };
  /// What the picture of the object depends on.
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
  gpu::Program<shaders::raster_occlude> occlude_;
  gpu::Program<shaders::raster_blend> blend_;
  std::vector<Mesh::Vec3> corners_;
  std::unique_ptr<Rasterizer> rasterizer_;
  gpu::BufferPtr picture_;
  Plane heights_, occlusion_;
  float ground_ = 0;  // height of the lowest corner
  std::optional<Drawn> kept_;
  std::optional<Shaded> kept_shadow_;
  uint64_t drawn_ = 0, shadows_ = 0;
};

}  // namespace inverse
