#include "layer_fade.hpp"

#include "kernels/gpu/shaders.hpp"
#include "kernels/image/quads.hpp"

INVERSE_SHADER(intrinsic_resolution_fade);

namespace inverse {

LayerFade::LayerFade(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : start_(device->kernel(shaders::intrinsic_resolution_fade, {1})),
      fade_(device->kernel(shaders::intrinsic_resolution_fade, {0})),
      planes_(device, extent) {}

void LayerFade::dispatch(gpu::Commands& commands, const gpu::KernelPtr& kernel,
                         const PlanePtr& frame, const PlanePtr& now, const PlanePtr& shown,
                         const PlanePtr& faded) const {
  const struct {
    uint32_t width, height;
    float share;
  } push{frame->extent.width, frame->extent.height, share_};
  commands.dispatch(kernel,
                    {frame->buffer, now->buffer, shown->buffer, between_->buffer, faded->buffer},
                    push, line_of(frame->extent.pixels()));
  commands.keep(between_);
}

void LayerFade::start(gpu::Commands& commands, const PlanePtr& frame, const PlanePtr& shown,
                      const PlanePtr& now) {
  between_ = planes_.acquire();
  frames_ = 0;
  share_ = 1;
  dispatch(commands, start_, frame, now, shown, between_);
}

PlanePtr LayerFade::record(gpu::Commands& commands, const PlanePtr& frame, const PlanePtr& now) {
  if (!between_) return now;
  share_ *= kShare;
  PlanePtr faded = planes_.acquire();
  dispatch(commands, fade_, frame, now, now, faded);
  commands.keep(faded);
  if (++frames_ == kFrames) stop();
  return faded;
}

}  // namespace inverse
