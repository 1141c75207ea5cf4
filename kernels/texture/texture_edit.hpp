// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/texture_compare.spv.hpp"
#include "kernels/texture_draw.spv.hpp"
#include "kernels/texture_hide.spv.hpp"
#include "kernels/texture_learn.spv.hpp"
#include "kernels/texture_soften.spv.hpp"
#include "quad.hpp"
#include "texture_pyramid.hpp"

namespace inverse {

/// How a picture is put on a plane.
struct TextureParams {
  /// Reflectance of white in the picture, in the scale of the intrinsic layer.
  float white = 0.9f;
  /// 0: nothing changes; 1: the picture replaces the reflectance.
  float opacity = 1;
  /// Multiply by the mask layer if there is one.
  bool use_mask = true;
  /// Hide the picture where the reflectance differs from the one learned for that spot …
  bool occlusion = true;
  /// … by more than this: rms difference of ln (R + .02) over R, G, B …
  float tolerance = 0.35f;
  /// … and completely by this much more.
  float softness = 0.2f;
};

/// Puts a picture on a plane of the reflectance (draw.comp): shading stays. Learns the reflectance
/// of the plane, to see what stands before it (compare.comp,
/// hide.comp, learn.comp, soften.comp).
class TextureEdit {
 public:
  TextureEdit(const std::shared_ptr<gpu::Device>& device, Extent frame);

  /// Forgets what the plane looks like; with another size in the picture, it is learned in other
  /// cells.
  void forget() { cells_ = {}; }
  /// Records the edit of `layers`, which must have Role::intrinsic and Role::model, by a picture
  /// at `corners`, with which nothing may be wrong (wrong_corners). Planes that others hold are not
  /// written. Values that are not finite count as 0 (infinity: as 65504); `params` are clamped to
  /// their ranges.
  void record(gpu::Commands& commands, Layers& layers, const TexturePyramid& picture,
              const Corners& corners, const TextureParams& params);

  /// Cells of a plane with these corners: some two pixels wide, at most kMaxCells in a row or
  /// column.
  static Extent cells_of(const Corners& corners);
  static constexpr uint32_t kMaxCells = 512;
  /// 0…1 a cell, of the last frame with `occlusion`.
  const gpu::BufferPtr& hidden() const { return softened_; }

 private:
  void compare(gpu::Commands& commands, const Layers& layers, const Corners& corners,
               const TextureParams& params);

  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_;
  gpu::Program<shaders::texture_compare> compare_;
  gpu::Program<shaders::texture_hide> hide_;
  gpu::Program<shaders::texture_learn> learn_;
  gpu::Program<shaders::texture_soften> soften_;
  std::array<gpu::Program<shaders::texture_draw>, 4> draw_;  // by MATTE + 2 HIDDEN
  Extent cells_;                                             // 0 × 0: nothing is learned
  gpu::BufferPtr learned_, observed_, excess_, hidden_, softened_;
};

}  // namespace inverse
