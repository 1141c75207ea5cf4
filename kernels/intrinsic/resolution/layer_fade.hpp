// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/intrinsic_resolution_fade.spv.hpp"

namespace inverse {

/// Fades from one solution's layers to another's over some frames, at pixels that do not change, so
/// that the change is not visible (fade.comp). Uses one plane while it lasts.
class LayerFade {
 public:
  LayerFade(const std::shared_ptr<gpu::Device>& device, Extent extent);
  /// Starts a fade: `shown` (R.rgb, S) is the output for `frame`, `now` the solution that later
  /// frames continue.
  void start(gpu::Commands& commands, const PlanePtr& frame, const PlanePtr& shown,
             const PlanePtr& now);
  /// The output for a later frame with solution `now` and Role::slope `slope`, or null; `now`
  /// itself after the fade.
  PlanePtr record(gpu::Commands& commands, const PlanePtr& frame, const PlanePtr& now,
                  const PlanePtr& slope);
  void stop() { between_.reset(); }
  bool on() const { return between_ != nullptr; }

  /// Share of the difference that stays from frame to frame, and frames until it is dropped.
  static constexpr float kShare = 0.8F;
  static constexpr unsigned kFrames = 20;

 private:
  using Fade = gpu::Program<shaders::intrinsic_resolution_fade>;
  void dispatch(gpu::Commands& commands, const Fade& fade, const PlanePtr& frame,
                const PlanePtr& now, const PlanePtr& shown, const PlanePtr& faded,
                const PlanePtr& slope) const;

  Fade start_, fade_, colored_fade_;
  PlanePool planes_;
  PlanePtr between_;
  unsigned frames_ = 0;
  float share_ = 1;
};

}  // namespace inverse
