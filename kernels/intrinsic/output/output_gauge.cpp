#include "output_gauge.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_output_gauge_count);
INVERSE_SHADER(intrinsic_output_gauge);

namespace inverse {
namespace {
constexpr uint32_t kGaugeBins = 512;  // gauge.glsl
constexpr uint32_t kLanes = 8;        // of gauge.comp, which works on one
}  // namespace

OutputGauge::OutputGauge(const std::shared_ptr<gpu::Device>& device)
    : count_(device->kernel(shaders::intrinsic_output_gauge_count)),
      gauge_kernel_(device->kernel(shaders::intrinsic_output_gauge, {}, kLanes)),
      counts_(gpu::Buffer::create(device, gpu::Element::word, kGaugeBins)),
      gauge_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {}

void OutputGauge::clear_once(gpu::Commands& commands) {
  if (!cleared_) {
    commands.fill(counts_);
    commands.fill(gauge_);
  }
  cleared_ = true;
}

void OutputGauge::take(gpu::Commands& commands, const OutputGauge& other) {
  clear_once(commands);
  commands.copy(other.gauge_, gauge_, gauge_->bytes());
}

void OutputGauge::record(gpu::Commands& commands, const Guide& guide, const gpu::BufferPtr& shading,
                         const gpu::BufferPtr& verdict, History history, const Params& params,
                         bool stays) {
  clear_once(commands);
  const std::array<uint32_t, 2> size{guide.extent().width, guide.extent().height};
  commands.dispatch(count_, {guide.cells(), shading, counts_}, size,
                    line_of(guide.cell_extent().pixels()));
  const struct {
    float quantile, log_target, share;
    uint32_t history, stays;
  } push{std::clamp(params.quantile, 0.0F, 1.0F), std::log(std::clamp(params.value, 0.05F, 1.0F)),
         std::clamp(params.share, 0.0F, 1.0F), static_cast<uint32_t>(history), stays ? 1U : 0U};
  commands.dispatch(gauge_kernel_, {counts_, verdict, gauge_}, push, {});
}

}  // namespace inverse
