#pragma once
#include <memory>
#include <optional>

#include "kernels/environment/lit_sphere.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/material/estimate/material.hpp"
#include "kernels/material_preview_preview.spv.hpp"

namespace inverse {

/// Draws a sphere that wears a material into a frame's bottom right corner.
class MaterialPreview {
 public:
  explicit MaterialPreview(const std::shared_ptr<gpu::Device>& device);

  /// `light` may be null: then it is that of a studio (Environment::studio). `size` is the sphere's
  /// diameter over the frame's shorter side, 0…1. `frame` and `picture` are of one size.
  void record(gpu::Commands& commands, const Plane& frame, const Material& material,
              const std::shared_ptr<const Environment>& light, float size, const Plane& picture);

 private:
  gpu::Program<shaders::material_preview_preview> kernel_;
  LitSphere sphere_;
  // What the sphere was drawn with. What moves less than can be seen is not drawn anew.
  std::optional<Surface> surface_;
  std::optional<std::shared_ptr<const Environment>> light_;
};

}  // namespace inverse
