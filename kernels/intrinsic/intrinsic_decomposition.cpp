#include "intrinsic_decomposition.hpp"

#include <array>
#include <cmath>

#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_cell_terms);
INVERSE_SHADER(intrinsic_assemble);
INVERSE_SHADER(intrinsic_layers);

namespace inverse {
IntrinsicDecomposition::IntrinsicDecomposition(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)),
      extent_(extent),
      planes_(device_, extent),
      guide_(device_, extent),
      prior_(device_, extent),
      anchor_(device_, extent),
      bins_(device_, guide_.cell_extent()),
      multigrid_(device_, extent),
      gauge_(device_),
      terms_kernel_(device_->kernel(shaders::intrinsic_cell_terms, {0})),
      anchored_terms_kernel_(device_->kernel(shaders::intrinsic_cell_terms, {1})),
      assemble_(device_->kernel(shaders::intrinsic_assemble, {0})),
      anchored_assemble_(device_->kernel(shaders::intrinsic_assemble, {1})),
      layers_(device_->kernel(shaders::intrinsic_layers, {0})),
      anchored_layers_(device_->kernel(shaders::intrinsic_layers, {1})) {
  const auto buffer = [&](uint64_t count) {
    return gpu::Buffer::create(device_, gpu::Element::vec4, count);
  };
  const uint64_t cell_quads = quads_of(guide_.cell_extent());
  flux_ = buffer(quads_of(extent) * EdgePrior::kFluxStride);
  value_ = buffer(cell_quads * EdgePrior::kValueStride);
  terms_ = buffer(cell_quads * Multigrid::kTermsStride);
  start_ = buffer(cell_quads * TemporalAnchor::kStartStride);
}

void IntrinsicDecomposition::assemble(gpu::Commands& commands, const TemporalAnchor::Params& params,
                                      bool anchored, bool continues) {
  if (anchored) anchor_.record(commands, guide_, params, continues);
  const Extent cells = guide_.cell_extent();
  const struct {
    uint32_t width, height;
    float anchor, frames, motion, hold, light;
  } push{cells.width,
         cells.height,
         params.anchor_weight,
         params.anchor_frames,
         1 / params.anchor_motion,
         params.hold,
         1 / params.hold_light};
  commands.dispatch(anchored ? anchored_terms_kernel_ : terms_kernel_,
                    {value_, guide_.cells(), anchor_.mismatch(), anchor_.tiles(), anchor_.verdict(),
                     anchor_.kept(), multigrid_.cell_means(), multigrid_.cell_correction(), terms_,
                     start_, multigrid_.cell_force()},
                    push, line_of(quads_of(cells)));
  const std::array<uint32_t, 2> size{extent_.width, extent_.height};
  commands.dispatch(anchored ? anchored_assemble_ : assemble_,
                    {flux_, start_, guide_.level0(), multigrid_.cell_force(), anchor_.memory(),
                     multigrid_.field(), multigrid_.system(), multigrid_.field(), anchor_.now()},
                    size, line_of(quads_of(extent_)));
}

void IntrinsicDecomposition::solve(gpu::Commands& commands, const Params& params) {
  Multigrid::Params multigrid = params.multigrid;
  // One cycle has none to be combined with; what it would exaggerate alone, the frames after it
  // would exaggerate again.
  if (stats_.cycles == 1) multigrid.slowest = 0;
  multigrid_.record_operators(commands, multigrid);
  bins_.record_weights(commands, guide_, terms_,
                       EdgePrior::kMostChroma * params.prior.chroma_weight);
  commands.stage("operators");
  const ChromaBins::State state{terms_,
                                multigrid_.cell_means(),
                                multigrid_.cell_correction(),
                                multigrid_.cell_far(),
                                multigrid_.cell_system(),
                                multigrid_.cell_force()};
  for (uint32_t cycle = 0; cycle < stats_.cycles; ++cycle)
    multigrid_.record_cycle(
        commands, multigrid, cycle,
        {stats_.stops || cycle + 1 == stats_.cycles, stats_.stops && cycle > 0, params.settled},
        [&] { bins_.record(commands, guide_, state); },
        [&] { bins_.record_force(commands, state); });
}

Layers IntrinsicDecomposition::record(gpu::Commands& commands, const PlanePtr& input,
                                      const Params& params, const FrameInfo& info) {
  if (info.reset) reset();
  const bool continues = stats_.history;  // the frame before had one before it
  stats_ = {};
  stats_.levels = multigrid_.depth();
  stats_.history = history_ && params.anchor.anchor_weight > 0;
  stats_.cycles = stats_.history ? params.warm_cycles : params.cycles;
  stats_.stops = params.adaptive && params.settled > 0 && (!stats_.history || may_settle(params));
  if (!stats_.history)
    stats_.skipped.emplace_back(history_ ? "anchor: its weight is 0" : "anchor: no frame before");

  guide_.record(commands, input->buffer);
  commands.stage("guide");
  const EdgePrior::Target target{multigrid_.system(), flux_, value_};
  stats_.tiles = prior_.tiles();
  if (!history_) prior_.reset();
  if (params.adaptive)
    prior_.record_changes(commands, guide_, target, params.prior, params.still_tolerance);
  else
    prior_.record(commands, guide_, target, params.prior);
  commands.stage("prior");
  assemble(commands, params.anchor, stats_.history, continues);
  commands.stage("assemble");
  solve(commands, params);

  using History = OutputGauge::History;
  gauge_.record(commands, guide_, multigrid_.field(), anchor_.verdict(),
                stats_.history             ? History::judged
                : history_ || gauge_taken_ ? History::taken_on
                                           : History::none,
                params.gauge);
  const PlanePtr intrinsic = planes_.acquire();
  const struct {
    uint32_t width, height;
    float texture;
  } push{extent_.width, extent_.height, 1 / params.anchor.hold_texture};
  commands.dispatch(stats_.history ? anchored_layers_ : layers_,
                    {input->buffer, guide_.cells(), guide_.wide(), gauge_.value(), start_,
                     anchor_.memory(), anchor_.now(), multigrid_.field(), anchor_.now(),
                     multigrid_.field(), anchor_.kept(), intrinsic->buffer},
                    push, line_of(guide_.cell_extent().pixels()));
  anchor_.advance();
  record_report(commands, params.adaptive);
  commands.stage("layers");
  history_ = true;
  gauge_taken_ = false;
  commands.keep(input);
  commands.keep(intrinsic);
  return intrinsic_layers(input, intrinsic);
}

bool IntrinsicDecomposition::may_settle(const Params& params) const {
  if (recorded_ < reports_.size()) return true;
  const uint64_t before = recorded_ - reports_.size();  // done, or this frame could not begin
  const Findings found = findings(before);
  if (found.cycles < report(before).stats.cycles) return true;
  // A cycle changes about a third of what the one before it did.
  return found.change < params.settled / 3;
}

void IntrinsicDecomposition::take_gauge(gpu::Commands& commands,
                                        const IntrinsicDecomposition& other) {
  reset();
  gauge_.take(commands, other.gauge_);
  gauge_taken_ = true;
}

void IntrinsicDecomposition::record_report(gpu::Commands& commands, bool adaptive) {
  Report& report = reports_[recorded_++ % reports_.size()];
  report.stats = stats_;
  report.adaptive = adaptive;
  if (!report.found)
    report.found = gpu::Buffer::create(device_, gpu::Element::vec4, 4, gpu::Memory::readback);
  constexpr uint64_t kVec4 = 16;
  commands.copy(multigrid_.progress(), report.found, kVec4, 0, 0);
  if (stats_.history) commands.copy(anchor_.verdict(), report.found, kVec4, 0, kVec4);
  commands.copy(gauge_.value(), report.found, kVec4, 0, 2 * kVec4);
  if (adaptive) commands.copy(prior_.control(), report.found, sizeof(uint32_t), 0, 3 * kVec4);
}

IntrinsicDecomposition::Findings IntrinsicDecomposition::findings(uint64_t frame) const {
  const Report& of = report(frame);
  const float* found = of.found->map_as<float>();
  Findings findings;
  findings.change = std::sqrt(found[0]);
  findings.cycles = of.stats.stops ? static_cast<uint32_t>(found[2]) : of.stats.cycles;
  if (of.stats.history) {
    findings.mismatch = found[4];
    findings.cut = found[5] == 0;
  }
  findings.gauge = found[8];
  findings.tiles_evaluated = of.adaptive ? of.found->map_as<uint32_t>()[12] : of.stats.tiles;
  return findings;
}

}  // namespace inverse
