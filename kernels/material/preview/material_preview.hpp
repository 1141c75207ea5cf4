// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>
#include <optional>

#include "kernels/environment/lit_sphere.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/material/estimate/material.hpp"
#include "kernels/material_preview_preview.spv.hpp"

namespace inverse {

/// Draws a sphere of a material into the bottom right corner of a frame.
class MaterialPreview {
 public:
  explicit MaterialPreview(const std::shared_ptr<gpu::Device>& device);

  /// `light` may be null: then a studio's light (Environment::studio) is used. `size` is the
  /// sphere's diameter relative to the frame's shorter side, 0…1. `frame` and `picture` have the
  /// same size.
  void record(gpu::Commands& commands, const Plane& frame, const Material& material,
              const std::shared_ptr<const Environment>& light, float size, const Plane& picture);

 private:
  gpu::Program<shaders::material_preview_preview> kernel_;
  LitSphere sphere_;
  // Parameters of the drawn sphere. Invisible changes do not redraw it.
  std::optional<Surface> surface_;
  std::optional<std::shared_ptr<const Environment>> light_;
};

}  // namespace inverse
