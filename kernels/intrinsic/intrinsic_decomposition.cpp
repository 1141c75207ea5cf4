#include "intrinsic_decomposition.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "../gpu/reduce.hpp"
#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_cell_terms);
INVERSE_SHADER(intrinsic_assemble);
INVERSE_SHADER(intrinsic_layers);
INVERSE_SHADER(intrinsic_rescale);
INVERSE_SHADER(intrinsic_take_over);
INVERSE_SHADER(intrinsic_total);

namespace inverse {
namespace {

// Frames from one look at bins and anchor to the next, where something is left out and where not.
constexpr uint64_t kLookAgain = 4, kLookEvery = 16;
// Where edges of most tiles are decided anew, comparing tiles costs more than it saves: frames from
// one comparison to the next.
constexpr uint64_t kCompareEvery = 8;

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
constexpr uint64_t kFoundChange = 0, kFoundVerdict = 1, kFoundGauge = 2, kFoundEvaluated = 3,
                   kFoundActive = 4, kFoundBusy = 5, kFoundStatistics = 6, kFoundKept = 8,
                   kFoundBinding = 10, kFoundGates = 11, kFoundSize = 12;
/// Share of tiles from which on a list of them saves nothing worth its trouble: where input has
/// changed, and of all that need work.
constexpr float kMostChanged = 0.25F, kMostBusy = 0.5F;
/// Frames of which only tiles are worked on, from one of which all are to the next; and the
/// tolerance that lists all.
constexpr uint64_t kAllEvery = 32;
constexpr float kAllTiles = -1;
/// How far the output's scale (log units) may be from what the frame would have before it moves,
/// and with it layers that are not written anew.
constexpr float kGaugeRest = 0.02F;

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
      active_(device_, extent),
      terms_kernel_(device_, shaders::intrinsic_cell_terms, {0, 0}, 0, 0),
      anchored_terms_kernel_(device_, shaders::intrinsic_cell_terms, {1, 0}, 1, 4),
      looking_terms_kernel_(device_, shaders::intrinsic_cell_terms, {1, 1}, 0, 0),
      assemble_(device_, shaders::intrinsic_assemble, {0}, 0, 0),
      anchored_assemble_(device_, shaders::intrinsic_assemble, {1}, 4, 16),
      layers_(device_, shaders::intrinsic_layers, {0}, 0, 0),
      anchored_layers_(device_, shaders::intrinsic_layers, {1}, 4, 4),
      rescale_(device_->kernel(shaders::intrinsic_rescale)),
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
  gate_sums_ = buffer(gpu::partial_count(*looking_terms_kernel_.whole(), line_of(cell_quads)));
  gate_total_ = buffer(1);
}

void IntrinsicDecomposition::assemble(gpu::Commands& commands, const TemporalAnchor::Params& params,
                                      bool look) {
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

void IntrinsicDecomposition::solve(gpu::Commands& commands, const Params& params, bool look) {
  Multigrid::Params multigrid = params.multigrid;
  // One cycle has none to be combined with; what it would exaggerate alone, the frames after it
  // would exaggerate again.
  if (stats_.cycles == 1) multigrid.slowest = 0;
  // The cells' problem of tiles left out is that of the frame before, and its solution so far is
  // kept: solving it again costs more than all else.
  if (listed() && !refreshes_) multigrid.cell_cycles = 1;
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
        [&] { bins_.record_force(commands, state, look); }, list());
}

Layers IntrinsicDecomposition::record(gpu::Commands& commands, const PlanePtr& input,
                                      const Params& params, const FrameInfo& info) {
  if (info.reset) reset();
  const Params problem = but_for_effort(params);
  if (!history_ || problem != params_) {
    since_reset_ = 0;
    params_ = problem;
  }
  judge(params);
  if (!taken_) continues_ = stats_.history;
  const Stats before = std::exchange(stats_, {});
  stats_.levels = multigrid_.depth();
  stats_.history = (history_ || taken_) && params.anchor.anchor_weight > 0;
  stats_.cycles = stats_.history ? params.warm_cycles : params.cycles;
  stats_.stops = params.adaptive && params.settled > 0 && (!stats_.history || may_settle(params));
  if (!stats_.history)
    stats_.skipped.emplace_back(history_ ? "anchor: its weight is 0" : "anchor: no frame before");
  const bool compares = params.adaptive && (!restless_ || since_reset_ % kCompareEvery == 0);
  const bool weighs = params.prior.chroma_weight > 0;
  stats_.holds = stats_.history && (!params.adaptive || holds_);
  mode_ = next_mode(params, info, before);
  since_all_ = listed() ? since_all_ + 1 : 0;
  refreshes_ = since_all_ % kAllEvery == kAllEvery - 1;
  // Over tiles that changed alone, there is nothing to be seen of the whole.
  const bool look = !listed() && params.adaptive &&
                    (since_reset_ == kLookAgain ||  // the first one with a settled history
                     since_reset_ % (binds_ && holds_ ? kLookEvery : kLookAgain) == 0);
  ++since_reset_;
  stats_.bins = weighs && (!params.adaptive || binds_ || look);
  if (!stats_.bins)
    stats_.skipped.emplace_back(weighs ? "chroma bins: they cannot bind"
                                       : "chroma bins: their weight is 0");
  if (stats_.history && !stats_.holds)
    stats_.skipped.emplace_back("anchor of pixels: nothing can be held");
  const bool look_at_bins = look && weighs, look_at_gate = look && stats_.history;
  EdgePrior::Params prior = params.prior;
  if (!stats_.bins) prior.chroma_weight = 0;
  if ((stats_.listed = listed())) {
    stats_.skipped.emplace_back("tiles: those that stay as they are");
    active_.record_list(commands, multigrid_.cell_correction(),
                        refreshes_ ? kAllTiles : params.tile_tolerance, params.anchor.hold);
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
  else if (compares)
    prior_.record_changes(commands, guide_, target, prior, params.still_tolerance);
  else
    prior_.record(commands, guide_, target, prior,
                  params.adaptive && since_reset_ % kCompareEvery == 0);
  commands.stage("prior");
  assemble(commands, params.anchor, look_at_gate);
  commands.stage("assemble");
  solve(commands, params, look_at_bins);

  using History = OutputGauge::History;
  gauge_.record(commands, guide_, multigrid_.field(), anchor_.verdict(),
                stats_.history       ? History::judged
                : history_ || taken_ ? History::taken_on
                                     : History::none,
                params.gauge, gauge_rests_);
  const PlanePtr intrinsic = layers_plane(commands);
  if (listed() && !gauge_rests_) rescale(commands, intrinsic->buffer);
  const struct {
    uint32_t width, height;
    float texture;
  } push{extent_.width, extent_.height, 1 / params.anchor.hold_texture};
  (stats_.holds ? anchored_layers_ : layers_)
      .dispatch(commands, list(),
                {input->buffer, guide_.cells(), guide_.wide(), gauge_.value(), start_,
                 anchor_.memory(), anchor_.now(), multigrid_.field(), anchor_.now(),
                 multigrid_.field(), anchor_.kept(), intrinsic->buffer},
                push, line_of(guide_.cell_extent().pixels()));
  if (mode_ != ActiveTiles::Mode::whole)
    active_.record_activity(commands, anchor_.memory(), anchor_.now(), list(),
                            params.tile_tolerance);
  anchor_.advance(commands, list());
  Report& report = record_report(commands, compares);
  if (look_at_bins) commands.copy(bins_.binding(), report.found, kVec4, 0, kFoundBinding * kVec4);
  if (look_at_gate) commands.copy(gate_total_, report.found, kVec4, 0, kFoundGates * kVec4);
  report.looked_at_bins = look_at_bins;
  report.looked_at_gate = look_at_gate;
  commands.stage("layers");
  active_.advance(mode_);
  last_ = mode_ == ActiveTiles::Mode::whole ? nullptr : intrinsic;
  history_ = true;
  taken_.reset();
  commands.keep(input);
  commands.keep(intrinsic);
  return intrinsic_layers(input, intrinsic);
}

ActiveTiles::Mode IntrinsicDecomposition::next_mode(const Params& params, const FrameInfo& info,
                                                    const Stats& before) {
  using Mode = ActiveTiles::Mode;
  const float changed = active_.take(info.changed);
  // As many tiles as make a cut are none to leave the others out for.
  if (!params.adaptive || params.tile_tolerance <= 0 || !stats_.history || !stats_.holds ||
      !before.holds || taken_ ||
      changed > std::min(kMostChanged, 0.9F * params.anchor.cut_fraction)) {
    calm_ = 0;
    gauge_rests_ = false;
    return Mode::whole;
  }
  gauge_rests_ = false;
  // Tiles left out keep what was decided for them.
  const bool bins = params.prior.chroma_weight > 0 && binds_;
  if (!last_ || since_reset_ == 0 || bins != before.bins) calm_ = 0;
  if (calm_++ < reports_.size()) return Mode::watched;
  // The last frame that is sure to be done, so that the same video always gives the same layers.
  const float* found = report(recorded_ - reports_.size()).found->map_as<float>();
  const auto of = [&](uint64_t slot) { return &found[4 * slot]; };
  const uint32_t busy = std::bit_cast<uint32_t>(*of(kFoundBusy));
  float drift = std::abs(*of(kFoundStatistics) - *of(kFoundKept)) * 0.25F;
  for (size_t i = 4; i < 8; ++i)
    drift = std::max(std::abs(of(kFoundStatistics)[i] - of(kFoundKept)[i]), drift);  // NaN stays
  const float off = std::abs(of(kFoundGauge)[2] - of(kFoundGauge)[0]);
  const bool worth = static_cast<float>(busy) <= kMostBusy * static_cast<float>(active_.tiles());
  if (!worth || !(drift <= params.still_tolerance)) return Mode::watched;
  gauge_rests_ = off <= kGaugeRest;
  return Mode::listed;
}

PlanePtr IntrinsicDecomposition::layers_plane(gpu::Commands& commands) {
  if (listed() && last_.use_count() == 1) return last_;
  PlanePtr plane = planes_.acquire();
  if (listed()) commands.copy(last_->buffer, plane->buffer, plane->buffer->bytes());
  return plane;
}

void IntrinsicDecomposition::rescale(gpu::Commands& commands, const gpu::BufferPtr& layers) {
  const auto pixels = static_cast<uint32_t>(extent_.pixels());
  commands.dispatch(rescale_, {gauge_.value(), layers, layers}, pixels, line_of(pixels));
}

bool IntrinsicDecomposition::may_settle(const Params& params) const {
  if (since_reset_ < reports_.size()) return true;  // of what was before a reset nothing follows
  const uint64_t before = recorded_ - reports_.size();  // done, or this frame could not begin
  const Findings found = findings(before);
  if (found.cycles < report(before).stats.cycles) return true;
  // A cycle changes about a third of what the one before it did.
  return found.change < params.settled / 3;
}

void IntrinsicDecomposition::judge(const Params& params) {
  if (since_reset_ < reports_.size()) {
    if (since_reset_ == 0) {
      binds_ = holds_ = true;
      restless_ = false;
    }
    return;
  }
  const uint64_t before = recorded_ - reports_.size();
  const Report& done = report(before);
  const Findings found = findings(before);
  if (done.checked_edges && done.stats.history)
    restless_ = 2 * found.tiles_evaluated > done.stats.tiles;
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
                                                                      bool compared) {
  Report& report = reports_[recorded_++ % reports_.size()];
  report.stats = stats_;
  report.checked_edges = compared && !listed();
  if (!report.found)
    report.found =
        gpu::Buffer::create(device_, gpu::Element::vec4, kFoundSize, gpu::Memory::readback);
  constexpr uint64_t kWord = 4;
  const auto copy = [&](const gpu::BufferPtr& from, uint64_t bytes, uint64_t slot) {
    commands.copy(from, report.found, bytes, 0, slot * kVec4);
  };
  copy(multigrid_.progress(), kVec4, kFoundChange);
  if (stats_.history) copy(anchor_.verdict(), kVec4, kFoundVerdict);
  copy(gauge_.value(), kVec4, kFoundGauge);
  if (listed()) copy(active_.list().words(), kWord, kFoundActive);
  if (compared && !listed()) copy(prior_.evaluated(), kWord, kFoundEvaluated);
  if (mode_ != ActiveTiles::Mode::whole) {
    copy(active_.busy(), kWord, kFoundBusy);
    copy(guide_.statistics(), 2 * kVec4, kFoundStatistics);
    copy(prior_.kept_statistics(), 2 * kVec4, kFoundKept);
  }
  return report;
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
  findings.gauge = found[4 * kFoundGauge];
  if (of.looked_at_bins)
    findings.binding =
        std::sqrt(found[4 * kFoundBinding] / std::max(found[4 * kFoundBinding + 1], 1e-20F));
  if (of.looked_at_gate)
    findings.gate =
        std::sqrt(found[4 * kFoundGates] / static_cast<float>(guide_.cell_extent().pixels()));
  const auto count = [&](uint64_t slot) { return std::bit_cast<uint32_t>(found[4 * slot]); };
  findings.tiles_active = of.stats.listed ? count(kFoundActive) : of.stats.tiles;
  findings.tiles_evaluated = of.stats.listed    ? findings.tiles_active
                             : of.checked_edges ? count(kFoundEvaluated)
                                                : of.stats.tiles;
  return findings;
}

}  // namespace inverse
