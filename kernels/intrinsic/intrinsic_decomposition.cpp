#include "intrinsic_decomposition.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "kernels/gpu/reduce.hpp"
#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_energy_cell_terms);
INVERSE_SHADER(intrinsic_energy_assemble);
INVERSE_SHADER(intrinsic_output_layers);
INVERSE_SHADER(intrinsic_energy_take_over);
INVERSE_SHADER(solve_total);

namespace inverse {
namespace {

/// What a frame is to be, without how much work is to go into it.
IntrinsicDecomposition::Params but_for_effort(IntrinsicDecomposition::Params params) {
  constexpr IntrinsicDecomposition::Params kUsual{};
  params.cycles = kUsual.cycles;
  params.warm_cycles = kUsual.warm_cycles;
  params.settled = kUsual.settled;
  params.still_tolerance = kUsual.still_tolerance;
  params.tile_tolerance = kUsual.tile_tolerance;
  return params;
}

constexpr uint64_t kVec4 = 16;  // bytes
// Where a report has what, in vec4, and how many.
constexpr uint64_t kFoundChange = 0, kFoundVerdict = 1, kFoundScale = 2, kFoundEvaluated = 3,
                   kFoundActive = 4, kFoundBusy = 5, kFoundStatistics = 6, kFoundKept = 8,
                   kFoundBinding = 10, kFoundGates = 11, kFoundSize = 12;
constexpr float kAllTiles = -1;  // the tolerance that lists all

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
      scale_(device_, guide_.cell_extent()),
      active_(device_, extent),
      terms_kernel_(device_, shaders::intrinsic_energy_cell_terms, {0, 0}, 0, 0),
      anchored_terms_kernel_(device_, shaders::intrinsic_energy_cell_terms, {1, 0}, 1, 4),
      looking_terms_kernel_(device_, shaders::intrinsic_energy_cell_terms, {1, 1}, 0, 0),
      assemble_(device_, shaders::intrinsic_energy_assemble, {0}, 0, 0),
      anchored_assemble_(device_, shaders::intrinsic_energy_assemble, {1}, 4, 16),
      layers_(device_, shaders::intrinsic_output_layers, {0}, 0, 0),
      anchored_layers_(device_, shaders::intrinsic_output_layers, {1}, 4, 4),
      take_over_(device_->kernel(shaders::intrinsic_energy_take_over)),
      total_(device_->kernel(shaders::solve_total)) {
  const auto buffer = [&](uint64_t count) {
    return gpu::Buffer::create(device_, gpu::Element::vec4, count);
  };
  const uint64_t cell_quads = quads_of(guide_.cell_extent());
  flux_ = buffer(quads_of(extent) * EdgePrior::kFluxStride);
  value_ = buffer(cell_quads * EdgePrior::kValueStride);
  terms_ = buffer(cell_quads * Multigrid::kTermsStride);
  start_ = buffer(cell_quads * TemporalAnchor::kStartStride);
  gate_sums_ = buffer(gpu::partial_count(*looking_terms_kernel_.whole(), line_of(cell_quads)));
  gate_total_ = buffer(1);
}

void IntrinsicDecomposition::assemble(gpu::Commands& commands,
                                      const TemporalAnchor::Params& params) {
  const bool look = plan_.looks_at_gate;
  if (stats_.history) anchor_.record(commands, guide_, params, continues_, list());
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
  (look             ? looking_terms_kernel_
   : stats_.history ? anchored_terms_kernel_
                    : terms_kernel_)
      .dispatch(commands, list(),
                {value_, guide_.cells(), anchor_.mismatch(), anchor_.tiles(), anchor_.verdict(),
                 anchor_.kept(), multigrid_.cell_means(), multigrid_.cell_correction(), terms_,
                 start_, multigrid_.cell_force(), gate_sums_, active_.activity()},
                push, line_of(quads_of(cells)));
  if (look)
    commands.dispatch(total_, {gate_sums_, gate_total_}, static_cast<uint32_t>(gate_sums_->count()),
                      {});
  const std::array<uint32_t, 2> size{extent_.width, extent_.height};
  (stats_.holds ? anchored_assemble_ : assemble_)
      .dispatch(commands, list(),
                {flux_, start_, guide_.level0(), multigrid_.cell_force(), anchor_.memory(),
                 multigrid_.field(), multigrid_.system(), multigrid_.field(), anchor_.now()},
                size, line_of(quads_of(extent_)));
}

void IntrinsicDecomposition::solve(gpu::Commands& commands, const Params& params) {
  Multigrid::Params multigrid = params.multigrid;
  // One cycle has none to be combined with; what it would exaggerate alone, the frames after it
  // would exaggerate again.
  if (stats_.cycles == 1) multigrid.slowest = 0;
  // The cells' problem of tiles left out is that of the frame before, and its solution so far is
  // kept: solving it again costs more than all else.
  if (listed() && !plan_.all_tiles) multigrid.cell_cycles = 1;
  multigrid_.record_operators(commands, multigrid, list());
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
        [&] { bins_.record_force(commands, state, plan_.looks_at_bins); }, list());
}

Layers IntrinsicDecomposition::record(gpu::Commands& commands, const PlanePtr& input,
                                      const Params& params, const FrameInfo& info) {
  if (info.reset) reset();
  const Params problem = but_for_effort(params);
  if (!history_ || problem != params_) leave_out_.restart();
  params_ = problem;
  if (!taken_) continues_ = stats_.history;
  const bool history = (history_ || taken_) && params.anchor.anchor_weight > 0;
  const bool weighs = params.prior.chroma_weight > 0;
  plan_ = leave_out_.next(
      {params.adaptive, weighs, params.settled, params.still_tolerance, params.chroma_tolerance,
       params.hold_tolerance, params.tile_tolerance, params.anchor.cut_fraction},
      {history, taken_.has_value(), last_ != nullptr, active_.take(info.changed)}, found_before());
  stats_ = {};
  stats_.levels = multigrid_.depth();
  stats_.history = history;
  stats_.cycles = history ? params.warm_cycles : params.cycles;
  stats_.stops = plan_.stops;
  stats_.holds = plan_.holds;
  stats_.bins = plan_.bins;
  stats_.listed = listed();
  if (!history)
    stats_.skipped.emplace_back(history_ ? "anchor: its weight is 0" : "anchor: no frame before");
  if (!plan_.bins)
    stats_.skipped.emplace_back(weighs ? "chroma bins: they cannot bind"
                                       : "chroma bins: their weight is 0");
  if (history && !plan_.holds) stats_.skipped.emplace_back("anchor of pixels: nothing can be held");
  EdgePrior::Params prior = params.prior;
  if (!plan_.bins) prior.chroma_weight = 0;
  if (listed()) {
    stats_.skipped.emplace_back("tiles: those that stay as they are");
    active_.record_list(commands, multigrid_.cell_correction(),
                        plan_.all_tiles ? kAllTiles : params.tile_tolerance, params.anchor.hold);
    multigrid_.record_residual(commands, active_.list_before());
    commands.stage("tiles");
  }

  guide_.record(commands, input->buffer, list());
  commands.stage("guide");
  if (taken_) start_from_taken(commands, input);
  const EdgePrior::Target target{multigrid_.system(), flux_, value_};
  stats_.tiles = prior_.tiles();
  if (!history_) prior_.reset();
  if (listed())
    prior_.record_tiles(commands, guide_, target, prior, active_.list());
  else if (plan_.compares_edges)
    prior_.record_changes(commands, guide_, target, prior, params.still_tolerance);
  else
    prior_.record(commands, guide_, target, prior, plan_.keeps_edges);
  commands.stage("prior");
  assemble(commands, params.anchor);
  commands.stage("assemble");
  solve(commands, params);

  using History = OutputScale::History;
  scale_.record(commands, guide_, multigrid_.field(), anchor_.verdict(),
                stats_.history       ? History::decided
                : history_ || taken_ ? History::taken
                                     : History::none,
                params.scale, listed());
  const PlanePtr intrinsic = layers_plane(commands);
  const struct {
    uint32_t width, height;
    float texture;
  } push{extent_.width, extent_.height, 1 / params.anchor.hold_texture};
  (stats_.holds ? anchored_layers_ : layers_)
      .dispatch(commands, list(),
                {input->buffer, guide_.cells(), guide_.wide(), scale_.value(), start_,
                 anchor_.memory(), anchor_.now(), multigrid_.field(), anchor_.now(),
                 multigrid_.field(), anchor_.kept(), intrinsic->buffer},
                push, line_of(guide_.cell_extent().pixels()));
  if (!whole())
    active_.record_activity(commands, anchor_.memory(), anchor_.now(), list(),
                            params.tile_tolerance);
  anchor_.advance(commands, list());
  record_report(commands);
  commands.stage("layers");
  active_.advance(listed());
  last_ = whole() ? nullptr : intrinsic;
  history_ = true;
  taken_.reset();
  commands.keep(input);
  commands.keep(intrinsic);
  return intrinsic_layers(input, intrinsic);
}

std::optional<LeaveOut::Found> IntrinsicDecomposition::found_before() const {
  if (recorded_ < reports_.size()) return {};
  const uint64_t number = recorded_ - reports_.size();  // done, or this frame could not begin
  const Report& done = report(number);
  const Findings findings = this->findings(number);
  LeaveOut::Found found;
  found.cycles = findings.cycles;
  found.cycles_recorded = done.stats.cycles;
  found.change = findings.change;
  found.history = done.stats.history;
  found.cut = findings.cut;
  found.compared_edges = done.compared_edges;
  found.looked_at_bins = done.looked_at_bins;
  found.looked_at_gate = done.looked_at_gate;
  found.tiles = done.stats.tiles;
  found.tiles_evaluated = findings.tiles_evaluated;
  found.binding = findings.binding;
  found.gate = findings.gate;
  const float* numbers = done.found->map_as<float>();
  const auto of = [&](uint64_t slot) { return &numbers[4 * slot]; };
  found.tiles_busy = std::bit_cast<uint32_t>(*of(kFoundBusy));
  // The statistics' first number is a mean, which may move four times as far.
  found.drift = std::abs(*of(kFoundStatistics) - *of(kFoundKept)) * 0.25F;
  for (size_t i = 4; i < 8; ++i)
    found.drift =
        std::max(std::abs(of(kFoundStatistics)[i] - of(kFoundKept)[i]), found.drift);  // NaN stays
  return found;
}

PlanePtr IntrinsicDecomposition::layers_plane(gpu::Commands& commands) {
  if (listed() && last_.use_count() == 1) return last_;
  PlanePtr plane = planes_.acquire();
  if (listed()) commands.copy(last_->buffer, plane->buffer, plane->buffer->bytes());
  return plane;
}

void IntrinsicDecomposition::take_over(gpu::Commands& commands, const IntrinsicDecomposition& other,
                                       PlanePtr intrinsic) {
  reset();
  scale_.take(commands, other.scale_);
  commands.copy(other.anchor_.verdict(), anchor_.verdict(), kVec4);
  continues_ = other.stats_.history;
  taken_ = std::move(intrinsic);
}

void IntrinsicDecomposition::start_from_taken(gpu::Commands& commands, const PlanePtr& input) {
  const std::array<uint32_t, 2> size{extent_.width, extent_.height};
  commands.dispatch(
      take_over_,
      {input->buffer, (*taken_)->buffer, guide_.cells(), guide_.wide(), scale_.value(),
       guide_.level0(), anchor_.memory(), multigrid_.field(), anchor_.kept(),
       multigrid_.cell_means(), multigrid_.cell_correction(), multigrid_.cell_force()},
      size, line_of(quads_of(guide_.cell_extent())));
  commands.keep(*taken_);
  commands.stage("take-over");
}

void IntrinsicDecomposition::record_report(gpu::Commands& commands) {
  Report& report = reports_[recorded_++ % reports_.size()];
  report.stats = stats_;
  report.compared_edges = plan_.compares_edges && !listed();
  report.looked_at_bins = plan_.looks_at_bins;
  report.looked_at_gate = plan_.looks_at_gate;
  if (!report.found)
    report.found =
        gpu::Buffer::create(device_, gpu::Element::vec4, kFoundSize, gpu::Memory::readback);
  constexpr uint64_t kWord = 4;
  const auto copy = [&](const gpu::BufferPtr& from, uint64_t bytes, uint64_t slot) {
    commands.copy(from, report.found, bytes, 0, slot * kVec4);
  };
  copy(multigrid_.progress(), kVec4, kFoundChange);
  if (stats_.history) copy(anchor_.verdict(), kVec4, kFoundVerdict);
  copy(scale_.value(), kVec4, kFoundScale);
  if (listed()) copy(active_.list().words(), kWord, kFoundActive);
  if (report.compared_edges) copy(prior_.evaluated(), kWord, kFoundEvaluated);
  if (report.looked_at_bins) copy(bins_.binding(), kVec4, kFoundBinding);
  if (report.looked_at_gate) copy(gate_total_, kVec4, kFoundGates);
  if (!whole()) {
    copy(active_.busy(), kWord, kFoundBusy);
    copy(guide_.statistics(), 2 * kVec4, kFoundStatistics);
    copy(prior_.kept_statistics(), 2 * kVec4, kFoundKept);
  }
}

IntrinsicDecomposition::Findings IntrinsicDecomposition::findings(uint64_t frame) const {
  const Report& of = report(frame);
  const float* found = of.found->map_as<float>();
  Findings findings;
  findings.change = std::sqrt(found[0]);
  findings.cycles = of.stats.stops ? static_cast<uint32_t>(found[2]) : of.stats.cycles;
  if (of.stats.history) {
    findings.mismatch = found[4 * kFoundVerdict];
    findings.cut = found[4 * kFoundVerdict + 1] == 0;
  }
  findings.scale = found[4 * kFoundScale];
  if (of.looked_at_bins)
    findings.binding =
        std::sqrt(found[4 * kFoundBinding] / std::max(found[4 * kFoundBinding + 1], 1e-20F));
  if (of.looked_at_gate)
    findings.gate =
        std::sqrt(found[4 * kFoundGates] / static_cast<float>(guide_.cell_extent().pixels()));
  const auto count = [&](uint64_t slot) { return std::bit_cast<uint32_t>(found[4 * slot]); };
  findings.tiles_active = of.stats.listed ? count(kFoundActive) : of.stats.tiles;
  findings.tiles_evaluated = of.stats.listed     ? findings.tiles_active
                             : of.compared_edges ? count(kFoundEvaluated)
                                                 : of.stats.tiles;
  return findings;
}

}  // namespace inverse
