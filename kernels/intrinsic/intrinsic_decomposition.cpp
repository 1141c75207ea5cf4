#include "intrinsic_decomposition.hpp"

#include <array>
#include <cmath>

#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_assemble);
INVERSE_SHADER(intrinsic_layers);

namespace inverse {
namespace {
const float kMostWeight = std::exp(3.0F);  // kLogHigh of prior.comp
}

IntrinsicDecomposition::IntrinsicDecomposition(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)),
      extent_(extent),
      planes_(device_, extent),
      guide_(device_, extent),
      prior_(device_),
      anchor_(device_, extent),
      bins_(device_, extent),
      multigrid_(device_, extent),
      assemble_(device_->kernel(shaders::intrinsic_assemble, {0})),
      assemble_anchored_(device_->kernel(shaders::intrinsic_assemble, {1})),
      layers_(device_->kernel(shaders::intrinsic_layers)),
      flux_(gpu::Buffer::create(device_, gpu::Element::vec4, quads_of(extent) * EdgePrior::kFluxStride)),
      value_(gpu::Buffer::create(device_, gpu::Element::vec4, quads_of(extent) * EdgePrior::kValueStride)),
      base_(gpu::Buffer::create(device_, gpu::Element::vec4, quads_of(extent))) {}

void IntrinsicDecomposition::assemble(gpu::Commands& commands, const TemporalAnchor::Params& params,
                                      bool anchored) {
  const struct {
    uint32_t width, height;
    float anchor, detail, chroma;
  } push{extent_.width, extent_.height, params.anchor_weight, 1 / params.anchor_detail, 1 / params.anchor_chroma};
  commands.dispatch(anchored ? assemble_anchored_ : assemble_,
                    {flux_, value_, guide_.level0(), guide_.cells(), anchor_.kept(), anchor_.blocks(),
                     anchor_.verdict(), multigrid_.system(), base_, multigrid_.field()},
                    push, line_of(quads_of(extent_)));
}

Layers IntrinsicDecomposition::record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                                      const FrameInfo& info) {
  if (info.reset) reset();
  stats_ = {};
  stats_.levels = multigrid_.depth();
  stats_.history = history_ && params.anchor.anchor_weight > 0;
  if (!stats_.history)
    stats_.skipped.emplace_back(history_ ? "anchor: its weight is 0" : "anchor: no frame before");

  guide_.record(commands, input->buffer);
  commands.stage("guide");
  prior_.record(commands, guide_, {multigrid_.system(), flux_, value_}, params.prior);
  commands.stage("prior");
  if (stats_.history) anchor_.record(commands, guide_, params.anchor);
  assemble(commands, params.anchor, stats_.history);
  commands.stage("assemble");

  const bool bins = params.prior.chroma_weight > 0;
  if (bins) bins_.record_frame(commands, guide_, value_, kMostWeight * params.prior.chroma_weight);
  else stats_.skipped.emplace_back("chroma bins: their weight is 0");
  stats_.cycles = stats_.history ? params.warm_cycles : params.cycles;
  for (uint32_t cycle = 0; cycle < stats_.cycles; ++cycle) {
    if (bins || cycle == 0) bins_.record(commands, guide_, value_, base_, multigrid_.field(), multigrid_.system());
    commands.stage("bins");
    multigrid_.record(commands, params.multigrid);
    commands.stage("solve");
  }

  const PlanePtr intrinsic = planes_.acquire();
  const std::array<uint32_t, 2> size{extent_.width, extent_.height};
  commands.dispatch(layers_,
                    {input->buffer, multigrid_.field(), guide_.level0(), guide_.cells(), intrinsic->buffer,
                     anchor_.kept()},
                    size, line_of(quads_of(extent_)));
  commands.stage("layers");
  history_ = true;
  commands.keep(input);
  commands.keep(intrinsic);
  Layers layers{extent_, {}};
  layers[Role::input] = input;
  layers[Role::model] = intrinsic;
  layers[Role::intrinsic] = intrinsic;
  return layers;
}

}  // namespace inverse
