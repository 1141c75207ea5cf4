// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>

#include "curve.hpp"
#include "kernels/edit_tone_apply.spv.hpp"
#include "kernels/edit_tone_level.spv.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

/// A change of shading. Its curve works on stops above middle shading, so that it means the same at
/// every exposure and every scale of S.
struct ToneParams {
  ToneCurve curve;
  /// Shading at 0 stops; 0: the geometric mean of S where the mask selects, followed over time.
  float middle = 0;
  /// 0: nothing changes; 1: the curve is fully in effect.
  float strength = 1;
  /// Multiply the strength by the mask layer if there is one.
  bool use_mask = true;
};

/// Changes shading by a tone curve (thesis 3.7.2, after Ye et al. 2014): S' = S 2^(w (f(x) − x)),
/// x = log2(S / middle), w = strength · mask. Reflectance stays. The color of light follows S by
/// itself (Role::slope), and layers of light (Layers::global) are shares and colors of S.
class Tone {
 public:
  Tone(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Records the edit of `layers`, which must have Role::intrinsic. Planes that others hold are not
  /// written. Does nothing if the curve is the identity or strength is 0. Values that are not
  /// finite count as 0 (infinity: as 65504); `params` are clamped to their ranges.
  void record(gpu::Commands& commands, Layers& layers, const ToneParams& params);

  /// Forgets the middle shading of earlier frames.
  void reset() { fresh_ = true; }

 private:
  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_;
  gpu::BufferPtr level_, curve_;
  // By MATTE; by MATTE + 2 MEASURED.
  std::array<gpu::Program<shaders::edit_tone_level>, 2> measure_;
  std::array<gpu::Program<shaders::edit_tone_apply>, 4> apply_;
  bool fresh_ = true;
};

}  // namespace inverse
