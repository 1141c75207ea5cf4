// SPDX-License-Identifier: LGPL-2.1-or-later
#include "layer_fade.hpp"

#include "kernels/image/pack4.hpp"

namespace inverse {

LayerFade::LayerFade(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : start_(device, {.start = true}),
      fade_(device),
      colored_fade_(device, {.colored = true}),
      planes_(device, extent) {}

void LayerFade::dispatch(gpu::Commands& commands, const Fade& fade, const PlanePtr& frame,
                         const PlanePtr& now, const PlanePtr& shown, const PlanePtr& faded,
                         const PlanePtr& slope) const {
  commands.dispatch_rows(fade,
                         {.frame = frame->buffer,
                          .intrinsic = now->buffer,
                          .shown = shown->buffer,
                          .between = gpu::by_rows(gpu::aliased(between_->buffer)),
                          .faded = gpu::by_rows(faded->buffer),
                          .slope = (slope ? slope : now)->buffer},
                         {.size = frame->extent, .share = share_, .first_row = 0},
                         {frame->extent.width, frame->extent.height});
  commands.keep(between_);
}

void LayerFade::start(gpu::Commands& commands, const PlanePtr& frame, const PlanePtr& shown,
                      const PlanePtr& now) {
  between_ = planes_.acquire();
  frames_ = 0;
  share_ = 1;
  dispatch(commands, start_, frame, now, shown, between_, nullptr);
}

PlanePtr LayerFade::record(gpu::Commands& commands, const PlanePtr& frame, const PlanePtr& now,
                           const PlanePtr& slope) {
  if (!between_) return now;
  share_ *= kShare;
  PlanePtr faded = planes_.acquire();
  dispatch(commands, slope ? colored_fade_ : fade_, frame, now, now, faded, slope);
  commands.keep(faded);
  if (++frames_ == kFrames) stop();
  return faded;
}

}  // namespace inverse
