// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/intrinsic_resolution_fade.spv.hpp"

namespace inverse {

/// Leads from one solution's layers to another's over the frames that follow, pixel by pixel where
/// the picture stays what it was, so that nobody sees the change (fade.comp). Holds a plane while
/// that goes on.
class LayerFade {
 public:
  LayerFade(const std::shared_ptr<gpu::Device>& device, Extent extent);
  /// Records that `shown` (R.rgb, S) went out for `frame`, where `now` is what the frames to come
  /// continue.
  void start(gpu::Commands& commands, const PlanePtr& frame, const PlanePtr& shown,
             const PlanePtr& now);
  /// What goes out for a later frame that was solved as `now`; `now` itself when the fade is over.
  PlanePtr record(gpu::Commands& commands, const PlanePtr& frame, const PlanePtr& now);
  void stop() { between_.reset(); }
  bool on() const { return between_ != nullptr; }

  /// What is left of the difference from frame to frame, and after how many it is dropped.
  static constexpr float kShare = 0.8F;
  static constexpr unsigned kFrames = 20;

 private:
  using Fade = gpu::Program<shaders::intrinsic_resolution_fade>;
  void dispatch(gpu::Commands& commands, const Fade& fade, const PlanePtr& frame,
                const PlanePtr& now, const PlanePtr& shown, const PlanePtr& faded) const;

  Fade start_, fade_;
  PlanePool planes_;
  PlanePtr between_;
  unsigned frames_ = 0;
  float share_ = 1;
};

}  // namespace inverse
