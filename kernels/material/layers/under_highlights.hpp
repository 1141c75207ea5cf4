#pragma once
#include <memory>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/material_layers_under_points.spv.hpp"
#include "kernels/material_layers_under_pull.spv.hpp"
#include "kernels/material_layers_under_push.spv.hpp"

namespace inverse {

/// The diffuse light of an object where highlights hide it. Where the camera was at its end a
/// picture does not say what is under a highlight; it is filled in from around it, by a pyramid of
/// means that leave out what is not known (pull-push).
class UnderHighlights {
 public:
  /// For squares of side x side points.
  UnderHighlights(const std::shared_ptr<gpu::Device>& device, uint32_t side);

  /// `masked` and `codes` are SpecularNet's and ExponentNet's input: sRGB where the object is with
  /// its mask, and the code of the specular layer in x.
  void record(gpu::Commands& commands, const gpu::BufferPtr& masked, const gpu::BufferPtr& codes);

  /// side x side points, linear RGB without gaps; 0 where nothing of the object is known.
  const gpu::BufferPtr& diffuse() const { return levels_.front().whole; }

 private:
  struct Level {
    uint32_t side;
    gpu::BufferPtr known, whole;  // rgb, w = whether; rgb
  };
  gpu::Program<shaders::material_layers_under_points> points_;
  gpu::Program<shaders::material_layers_under_pull> pull_;
  gpu::Program<shaders::material_layers_under_push> push_;
  std::vector<Level> levels_;  // the last one is a single point
};

}  // namespace inverse
