// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"

namespace inverse {

/// Draws the light of frames with layers of light (Layers::global) or, of Role::slope, all of it;
/// linear RGB, w = 1.
class LightPicture {
 public:
  enum class What : uint8_t {
    all,       ///< direct and indirect light, in color
    direct,    ///< directly from the lamps, in their color
    indirect,  ///< the rest, in color
    layer,     ///< light that bounced off one base color; black if there is no such color
  };
  explicit LightPicture(const std::shared_ptr<gpu::Device>& device);

  /// `layers` must have the target's extent and be global, or What::all and a slope; `base` is
  /// 0…kMaxBases − 1.
  void record(gpu::Commands& commands, const Layers& layers, What what, const Plane& target,
              uint32_t base = 0) const;

 private:
  std::shared_ptr<gpu::Device> device_;
};

}  // namespace inverse
