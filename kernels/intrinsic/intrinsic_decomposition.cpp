#include "intrinsic_decomposition.hpp"

#include <algorithm>
#include <cmath>

#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_guide);
INVERSE_SHADER(intrinsic_anchor);
INVERSE_SHADER(intrinsic_reweight);
INVERSE_SHADER(intrinsic_output);

namespace inverse {
namespace {
constexpr uint32_t kRows = 4;
constexpr uint32_t kEdgeStride = 3;
constexpr uint32_t kKeptStride = 3;
}  // namespace

IntrinsicDecomposition::IntrinsicDecomposition(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)),
      extent_(extent),
      planes_(device_, extent),
      prior_(device_),
      multigrid_(device_, extent),
      guide_kernel_(device_->kernel(shaders::intrinsic_guide)),
      anchor_kernel_(device_->kernel(shaders::intrinsic_anchor)),
      reweight_kernels_{device_->kernel(shaders::intrinsic_reweight, {kRows, 0}),
                        device_->kernel(shaders::intrinsic_reweight, {kRows, 1}),
                        device_->kernel(shaders::intrinsic_reweight, {kRows, 2})},
      output_kernel_(device_->kernel(shaders::intrinsic_output)) {
  const auto plane = [&](uint32_t stride) {
    return gpu::Buffer::create(device_, gpu::Element::vec4, quads_of(extent) * stride);
  };
  guide_ = {extent, plane(1), plane(1), plane(1), plane(1)};
  edges_ = {plane(kEdgeStride), plane(kEdgeStride)};
  anchored_ = plane(1);
  kept_ = {plane(kKeptStride), plane(kKeptStride)};
  control_ = gpu::Buffer::create(device_, gpu::Element::vec4, 1, gpu::Memory::upload);
  control_->map_as<float>()[0] = 1;
}

void IntrinsicDecomposition::anchor(gpu::Commands& commands, const Params& params, bool warm) {
  const struct {
    uint32_t width, height;
    float gauge, temporal, spread2, trust;
  } push{extent_.width,   extent_.height,
         params.gauge,    params.temporal,
         params.temporal_spread * params.temporal_spread, warm ? 1.0F : 0.0F};
  commands.dispatch(anchor_kernel_,
                    {guide_.mean, guide_.excess, guide_.chroma0, guide_.chroma1, kept_[0], control_,
                     multigrid_.system(), anchored_, multigrid_.field()},
                    push, {quads_of(extent_.width) * extent_.height});
}

void IntrinsicDecomposition::reweight(gpu::Commands& commands, float p, float floor) {
  const size_t variant = p == 1.0F ? 1 : p == 2.0F ? 2 : 0;
  const struct {
    uint32_t width, height;
    float p, floor2;
  } push{extent_.width, extent_.height, p, floor * floor};
  commands.dispatch(reweight_kernels_[variant],
                    {multigrid_.field(), guide_.mean, edges_.right, edges_.down, anchored_,
                     multigrid_.system()},
                    push, {quads_of(extent_.width) * ((extent_.height + kRows - 1) / kRows)});
}

Layers IntrinsicDecomposition::record(gpu::Commands& commands, const PlanePtr& input,
                                      const Params& params, const FrameInfo& info) {
  if (info.reset) reset();
  const bool warm = history_;
  stats_ = {};
  const gpu::Items quads{quads_of(extent_.width) * extent_.height};
  const struct {
    uint32_t width, height;
    float intensity_floor, chroma_floor;
  } push{extent_.width, extent_.height, params.intensity_floor, params.chroma_floor};
  commands.dispatch(guide_kernel_,
                    {input->buffer, guide_.mean, guide_.excess, guide_.chroma0, guide_.chroma1},
                    push, quads);
  commands.stage("guide");
  prior_.record(commands, guide_, edges_, params.edges);
  commands.stage("prior");
  anchor(commands, params, warm);
  commands.stage("anchor");
  stats_.steps = warm ? params.warm_steps : params.steps;
  for (uint32_t step = 0; step < stats_.steps; ++step) {
    const bool quadratic = !warm && step == 0;
    const float floor = warm ? params.edge_floor
                             : std::max(params.edge_floor, 0.3F * std::ldexp(1.0F, -static_cast<int>(step)));
    reweight(commands, quadratic ? 2.0F : params.p, floor);
    commands.stage("reweight");
    for (uint32_t cycle = 0; cycle < params.cycles; ++cycle)
      multigrid_.record(commands, params.multigrid);
    commands.stage("solve");
  }
  stats_.cycles = stats_.steps * params.cycles;
  stats_.levels = multigrid_.depth();
  stats_.warm = warm;

  Layers layers{extent_, {}};
  PlanePtr intrinsic = planes_.acquire();
  const uint32_t size[2] = {extent_.width, extent_.height};
  commands.dispatch(output_kernel_,
                    {input->buffer, multigrid_.field(), guide_.mean, guide_.chroma0, guide_.chroma1,
                     intrinsic->buffer, kept_[1]},
                    size, quads);
  commands.stage("output");
  std::swap(kept_[0], kept_[1]);
  history_ = true;
  commands.keep(input);
  commands.keep(intrinsic);
  layers[Role::input] = input;
  layers[Role::model] = intrinsic;
  layers[Role::intrinsic] = std::move(intrinsic);
  return layers;
}

}  // namespace inverse
