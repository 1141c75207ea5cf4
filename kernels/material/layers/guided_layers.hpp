// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/material_layers_guided_colors.spv.hpp"
#include "kernels/material_layers_guided_lines.spv.hpp"
#include "kernels/material_layers_guided_mean.spv.hpp"
#include "kernels/material_layers_guided_planes.spv.hpp"
#include "kernels/material_layers_guided_points.spv.hpp"

namespace inverse {

/// Mask and specular layer of an object as local linear functions of the image: the mask of its
/// color (planes), the specular layer of its smallest channel (lines). The networks compute both at
/// few points; these functions transfer them to full resolution with the edges of the frame (guided
/// filter over 5 x 5 points: He, Sun and Tang, Guided Image Filtering, 2010; subsampled: He and
/// Sun, Fast Guided Filter, 2015).
class GuidedLayers {
 public:
  /// For squares of side x side points.
  GuidedLayers(const std::shared_ptr<gpu::Device>& device, uint32_t side);

  /// `image` is SegmentationNet's input, sRGB; `probability` its output, 0 at masked-out points.
  void record_mask(gpu::Commands& commands, const gpu::BufferPtr& image,
                   const gpu::BufferPtr& probability);
  /// `masked` and `codes` are the inputs of SpecularNet and ExponentNet: sRGB of the object with
  /// its mask, and the code of the specular layer in x.
  void record_specular(gpu::Commands& commands, const gpu::BufferPtr& masked,
                       const gpu::BufferPtr& codes);

  /// side x side points: probability = rgb · sqrt(linear RGB) + w.
  const gpu::BufferPtr& mask() const { return mask_; }
  /// side x side points: layer = x · smallest channel + y, in linear light; x in 0…1.
  const gpu::BufferPtr& specular() const { return specular_; }

 private:
  int32_t side() const { return static_cast<int32_t>(side_); }
  int32_t count() const { return side() * side(); }
  gpu::Items each() const { return {side_ * side_}; }

  uint32_t side_;
  gpu::Program<shaders::material_layers_guided_colors> mask_points_;
  gpu::Program<shaders::material_layers_guided_planes> mask_fit_;
  gpu::Program<shaders::material_layers_guided_mean> mask_mean_;
  gpu::Program<shaders::material_layers_guided_points> specular_points_;
  gpu::Program<shaders::material_layers_guided_lines> specular_fit_;
  gpu::Program<shaders::material_layers_guided_mean> specular_mean_;
  gpu::BufferPtr mask_, specular_, points_, fits_;
};

}  // namespace inverse
