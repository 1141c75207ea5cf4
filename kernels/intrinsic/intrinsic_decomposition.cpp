#include "intrinsic_decomposition.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "../gpu/reduce.hpp"
#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_cell_terms);
INVERSE_SHADER(intrinsic_assemble);
INVERSE_SHADER(intrinsic_layers);
INVERSE_SHADER(intrinsic_take_over);
INVERSE_SHADER(intrinsic_total);

namespace inverse {
namespace {
constexpr uint64_t kVec4 = 16;  // bytes
// Frames from one look at bins and anchor to the next, where something is left out and where not.
constexpr uint64_t kLookAgain = 4, kLookEvery = 16;
}  // namespace

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
      terms_kernel_(device_->kernel(shaders::intrinsic_cell_terms, {0, 0})),
      anchored_terms_kernel_(device_->kernel(shaders::intrinsic_cell_terms, {1, 0})),
      looking_terms_kernel_(device_->kernel(shaders::intrinsic_cell_terms, {1, 1})),
      assemble_(device_->kernel(shaders::intrinsic_assemble, {0})),
      anchored_assemble_(device_->kernel(shaders::intrinsic_assemble, {1})),
      layers_(device_->kernel(shaders::intrinsic_layers, {0})),
      anchored_layers_(device_->kernel(shaders::intrinsic_layers, {1})),
      take_over_(device_->kernel(shaders::intrinsic_take_over)),
      total_(device_->kernel(shaders::intrinsic_total)) {
  const auto buffer = [&](uint64_t count) {
    return gpu::Buffer::create(device_, gpu::Element::vec4, count);
  };
  const uint64_t cell_quads = quads_of(guide_.cell_extent());
  flux_ = buffer(quads_of(extent) * EdgePrior::kFluxStride);
  value_ = buffer(cell_quads * EdgePrior::kValueStride);
  terms_ = buffer(cell_quads * Multigrid::kTermsStride);
  start_ = buffer(cell_quads * TemporalAnchor::kStartStride);
  gate_sums_ = buffer(gpu::partial_count(*looking_terms_kernel_, line_of(cell_quads)));
  gate_total_ = buffer(1);
}

void IntrinsicDecomposition::assemble(gpu::Commands& commands, const TemporalAnchor::Params& params,
                                      bool look) {
  if (stats_.history) anchor_.record(commands, guide_, params, continues_);
  if (look && !cleared_) {
    commands.fill(gate_sums_);
    cleared_ = true;
  }
  const Extent cells = guide_.cell_extent();
  const struct {
    uint32_t width, height;
    float anchor, frames, motion, hold, light;
  } push{cells.width,
         cells.height,
         stats_.holds ? params.anchor_weight : 0,
         params.anchor_frames,
         1 / params.anchor_motion,
         params.hold,
         1 / params.hold_light};
  commands.dispatch(look             ? looking_terms_kernel_
                    : stats_.history ? anchored_terms_kernel_
                                     : terms_kernel_,
                    {value_, guide_.cells(), anchor_.mismatch(), anchor_.tiles(), anchor_.verdict(),
                     anchor_.kept(), multigrid_.cell_means(), multigrid_.cell_correction(), terms_,
                     start_, multigrid_.cell_force(), gate_sums_},
                    push, line_of(quads_of(cells)));
  if (look)
    commands.dispatch(total_, {gate_sums_, gate_total_}, static_cast<uint32_t>(gate_sums_->count()),
                      {});
  const std::array<uint32_t, 2> size{extent_.width, extent_.height};
  commands.dispatch(stats_.holds ? anchored_assemble_ : assemble_,
                    {flux_, start_, guide_.level0(), multigrid_.cell_force(), anchor_.memory(),
                     multigrid_.field(), multigrid_.system(), multigrid_.field(), anchor_.now()},
                    size, line_of(quads_of(extent_)));
}

void IntrinsicDecomposition::solve(gpu::Commands& commands, const Params& params, bool look) {
  Multigrid::Params multigrid = params.multigrid;
  // One cycle has none to be combined with; what it would exaggerate alone, the frames after it
  // would exaggerate again.
  if (stats_.cycles == 1) multigrid.slowest = 0;
  multigrid_.record_operators(commands, multigrid);
  bins_.record_weights(commands, guide_, terms_,
                       stats_.bins ? EdgePrior::kMostChroma * params.prior.chroma_weight : 0);
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
        [&] { bins_.record_force(commands, state, look); });
}

Layers IntrinsicDecomposition::record(gpu::Commands& commands, const PlanePtr& input,
                                      const Params& params, const FrameInfo& info) {
  if (info.reset) reset();
  if (!history_ || params != params_) {
    since_reset_ = 0;
    params_ = params;
  }
  judge(params);
  if (!taken_) continues_ = stats_.history;
  stats_ = {};
  stats_.levels = multigrid_.depth();
  stats_.history = (history_ || taken_) && params.anchor.anchor_weight > 0;
  stats_.cycles = stats_.history ? params.warm_cycles : params.cycles;
  stats_.stops = params.adaptive && params.settled > 0 && (!stats_.history || may_settle(params));
  if (!stats_.history)
    stats_.skipped.emplace_back(history_ ? "anchor: its weight is 0" : "anchor: no frame before");
  const bool look =
      params.adaptive && (since_reset_ == kLookAgain ||  // the first one with a settled history
                          since_reset_ % (binds_ && holds_ ? kLookEvery : kLookAgain) == 0);
  ++since_reset_;
  const bool weighs = params.prior.chroma_weight > 0;
  stats_.bins = weighs && (!params.adaptive || binds_ || look);
  if (!stats_.bins)
    stats_.skipped.emplace_back(weighs ? "chroma bins: they cannot bind"
                                       : "chroma bins: their weight is 0");
  stats_.holds = stats_.history && (!params.adaptive || holds_);
  if (stats_.history && !stats_.holds)
    stats_.skipped.emplace_back("anchor of pixels: nothing can be held");
  const bool look_at_bins = look && weighs, look_at_gate = look && stats_.history;
  EdgePrior::Params prior = params.prior;
  if (!stats_.bins) prior.chroma_weight = 0;

  guide_.record(commands, input->buffer);
  commands.stage("guide");
  if (taken_) start_from_taken(commands, input);
  const EdgePrior::Target target{multigrid_.system(), flux_, value_};
  stats_.tiles = prior_.tiles();
  if (!history_) prior_.reset();
  if (params.adaptive)
    prior_.record_changes(commands, guide_, target, prior, params.still_tolerance);
  else
    prior_.record(commands, guide_, target, prior);
  commands.stage("prior");
  assemble(commands, params.anchor, look_at_gate);
  commands.stage("assemble");
  solve(commands, params, look_at_bins);

  using History = OutputGauge::History;
  gauge_.record(commands, guide_, multigrid_.field(), anchor_.verdict(),
                stats_.history       ? History::judged
                : history_ || taken_ ? History::taken_on
                                     : History::none,
                params.gauge);
  const PlanePtr intrinsic = planes_.acquire();
  const struct {
    uint32_t width, height;
    float texture;
  } push{extent_.width, extent_.height, 1 / params.anchor.hold_texture};
  commands.dispatch(stats_.holds ? anchored_layers_ : layers_,
                    {input->buffer, guide_.cells(), guide_.wide(), gauge_.value(), start_,
                     anchor_.memory(), anchor_.now(), multigrid_.field(), anchor_.now(),
                     multigrid_.field(), anchor_.kept(), intrinsic->buffer},
                    push, line_of(guide_.cell_extent().pixels()));
  anchor_.advance();
  Report& report = record_report(commands, params.adaptive);
  if (look_at_bins) commands.copy(bins_.binding(), report.found, kVec4, 0, 4 * kVec4);
  if (look_at_gate) commands.copy(gate_total_, report.found, kVec4, 0, 5 * kVec4);
  report.looked_at_bins = look_at_bins;
  report.looked_at_gate = look_at_gate;
  commands.stage("layers");
  history_ = true;
  taken_.reset();
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

void IntrinsicDecomposition::judge(const Params& params) {
  if (since_reset_ < reports_.size()) {
    if (since_reset_ == 0) binds_ = holds_ = true;
    return;
  }
  const uint64_t before = recorded_ - reports_.size();
  const Report& done = report(before);
  const Findings found = findings(before);
  if (done.looked_at_bins) binds_ = found.cut || !(found.binding < params.chroma_tolerance);
  if (done.looked_at_gate) holds_ = !(found.gate < params.hold_tolerance);
}

void IntrinsicDecomposition::take_over(gpu::Commands& commands, const IntrinsicDecomposition& other,
                                       PlanePtr intrinsic) {
  reset();
  gauge_.take(commands, other.gauge_);
  commands.copy(other.anchor_.verdict(), anchor_.verdict(), kVec4);
  continues_ = other.stats_.history;
  taken_ = std::move(intrinsic);
}

void IntrinsicDecomposition::start_from_taken(gpu::Commands& commands, const PlanePtr& input) {
  const std::array<uint32_t, 2> size{extent_.width, extent_.height};
  commands.dispatch(
      take_over_,
      {input->buffer, (*taken_)->buffer, guide_.cells(), guide_.wide(), gauge_.value(),
       guide_.level0(), anchor_.memory(), multigrid_.field(), anchor_.kept(),
       multigrid_.cell_means(), multigrid_.cell_correction(), multigrid_.cell_force()},
      size, line_of(quads_of(guide_.cell_extent())));
  commands.keep(*taken_);
  commands.stage("take over");
}

IntrinsicDecomposition::Report& IntrinsicDecomposition::record_report(gpu::Commands& commands,
                                                                      bool adaptive) {
  Report& report = reports_[recorded_++ % reports_.size()];
  report.stats = stats_;
  report.adaptive = adaptive;
  if (!report.found)
    report.found = gpu::Buffer::create(device_, gpu::Element::vec4, 6, gpu::Memory::readback);
  commands.copy(multigrid_.progress(), report.found, kVec4, 0, 0);
  if (stats_.history) commands.copy(anchor_.verdict(), report.found, kVec4, 0, kVec4);
  commands.copy(gauge_.value(), report.found, kVec4, 0, 2 * kVec4);
  if (adaptive) commands.copy(prior_.control(), report.found, sizeof(uint32_t), 0, 3 * kVec4);
  return report;
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
  if (of.looked_at_bins) findings.binding = std::sqrt(found[16] / std::max(found[17], 1e-20F));
  if (of.looked_at_gate)
    findings.gate = std::sqrt(found[20] / static_cast<float>(guide_.cell_extent().pixels()));
  findings.tiles_evaluated = of.adaptive ? of.found->map_as<uint32_t>()[12] : of.stats.tiles;
  return findings;
}

}  // namespace inverse
