#include "intrinsic_decomposition.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "../gpu/shaders.hpp"

INVERSE_SHADER(intrinsic_cell_terms);
INVERSE_SHADER(intrinsic_assemble);
INVERSE_SHADER(intrinsic_layers);
INVERSE_SHADER(intrinsic_rescale);

namespace inverse {
namespace {

// Where a report has what, in vec4, and how many.
constexpr uint64_t kFoundChange = 0, kFoundVerdict = 1, kFoundGauge = 2, kFoundEvaluated = 3,
                   kFoundActive = 4, kFoundBusy = 5, kFoundStatistics = 6, kFoundKept = 8,
                   kFoundSize = 10;
/// Share of tiles from which on a list of them saves nothing worth its trouble: where input has
/// changed, and of all that need work.
constexpr float kMostChanged = 0.25F, kMostBusy = 0.5F;
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
      terms_kernel_(device_, shaders::intrinsic_cell_terms, {0}, 0, 0),
      anchored_terms_kernel_(device_, shaders::intrinsic_cell_terms, {1}, 1, 4),
      assemble_(device_, shaders::intrinsic_assemble, {0}, 0, 0),
      anchored_assemble_(device_, shaders::intrinsic_assemble, {1}, 4, 16),
      layers_(device_, shaders::intrinsic_layers, {0}, 0, 0),
      anchored_layers_(device_, shaders::intrinsic_layers, {1}, 4, 4),
      rescale_(device_->kernel(shaders::intrinsic_rescale)) {
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
  if (anchored) anchor_.record(commands, guide_, params, continues, list());
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
  (anchored ? anchored_terms_kernel_ : terms_kernel_)
      .dispatch(commands, list(),
                {value_, guide_.cells(), anchor_.mismatch(), anchor_.tiles(), anchor_.verdict(),
                 anchor_.kept(), multigrid_.cell_means(), multigrid_.cell_correction(), terms_,
                 start_, multigrid_.cell_force()},
                push, line_of(quads_of(cells)));
  const std::array<uint32_t, 2> size{extent_.width, extent_.height};
  (anchored ? anchored_assemble_ : assemble_)
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
  if (listed()) multigrid.cell_cycles = 1;
  multigrid_.record_operators(commands, multigrid, list());
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
        [&] { bins_.record_force(commands, state); }, list());
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
  mode_ = next_mode(params, info);
  if ((stats_.listed = listed())) {
    stats_.skipped.emplace_back("tiles: those that stay as they are");
    active_.record_list(commands, multigrid_.cell_correction(), params.tile_tolerance,
                        1 - params.anchor.hold);
    multigrid_.record_residual(commands, active_.list_before());
    commands.stage("tiles");
  }

  guide_.record(commands, input->buffer, list());
  commands.stage("guide");
  const EdgePrior::Target target{multigrid_.system(), flux_, value_};
  stats_.tiles = prior_.tiles();
  if (!history_) prior_.reset();
  if (listed())
    prior_.record_tiles(commands, guide_, target, params.prior, active_.list());
  else if (params.adaptive)
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
                params.gauge, gauge_rests_);
  const PlanePtr intrinsic = layers_plane(commands);
  if (listed() && !gauge_rests_) rescale(commands, intrinsic->buffer);
  const struct {
    uint32_t width, height;
    float texture;
  } push{extent_.width, extent_.height, 1 / params.anchor.hold_texture};
  (stats_.history ? anchored_layers_ : layers_)
      .dispatch(commands, list(),
                {input->buffer, guide_.cells(), guide_.wide(), gauge_.value(), start_,
                 anchor_.memory(), anchor_.now(), multigrid_.field(), anchor_.now(),
                 multigrid_.field(), anchor_.kept(), intrinsic->buffer},
                push, line_of(guide_.cell_extent().pixels()));
  if (mode_ != ActiveTiles::Mode::whole)
    active_.record_activity(commands, anchor_.memory(), anchor_.now(), list(),
                            params.tile_tolerance);
  anchor_.advance(commands, list());
  record_report(commands, params.adaptive);
  commands.stage("layers");
  active_.advance(mode_);
  last_ = mode_ == ActiveTiles::Mode::whole ? nullptr : intrinsic;
  last_params_ = params;
  history_ = true;
  gauge_taken_ = false;
  commands.keep(input);
  commands.keep(intrinsic);
  return intrinsic_layers(input, intrinsic);
}

ActiveTiles::Mode IntrinsicDecomposition::next_mode(const Params& params, const FrameInfo& info) {
  using Mode = ActiveTiles::Mode;
  const float changed = active_.take(info.changed);
  // As many tiles as make a cut are none to leave the others out for.
  if (!params.adaptive || params.tile_tolerance <= 0 || !stats_.history ||
      changed > std::min(kMostChanged, 0.9F * params.anchor.cut_fraction)) {
    calm_ = 0;
    gauge_rests_ = false;
    return Mode::whole;
  }
  gauge_rests_ = false;
  if (!last_ || params != last_params_) calm_ = 0;
  if (calm_++ < reports_.size()) return Mode::watched;
  // The last frame that is sure to be done, so that the same video always gives the same layers.
  const float* found = report(recorded_ - reports_.size()).found->map_as<float>();
  const auto of = [&](uint64_t slot) { return &found[4 * slot]; };
  const uint32_t busy = std::bit_cast<uint32_t>(*of(kFoundBusy));
  float drift = std::abs(*of(kFoundStatistics) - *of(kFoundKept)) * 0.25F;
  for (size_t i = 4; i < 8; ++i)
    drift = std::max(drift, std::abs(of(kFoundStatistics)[i] - of(kFoundKept)[i]));
  const float off = std::abs(of(kFoundGauge)[2] - of(kFoundGauge)[0]);
  const bool worth = static_cast<float>(busy) <= kMostBusy * static_cast<float>(active_.tiles());
  if (!worth || drift > params.still_tolerance) return Mode::watched;
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
  report.mode = mode_;
  if (!report.found)
    report.found =
        gpu::Buffer::create(device_, gpu::Element::vec4, kFoundSize, gpu::Memory::readback);
  constexpr uint64_t kVec4 = 16, kWord = 4;
  const auto copy = [&](const gpu::BufferPtr& from, uint64_t bytes, uint64_t slot) {
    commands.copy(from, report.found, bytes, 0, slot * kVec4);
  };
  copy(multigrid_.progress(), kVec4, kFoundChange);
  if (stats_.history) copy(anchor_.verdict(), kVec4, kFoundVerdict);
  copy(gauge_.value(), kVec4, kFoundGauge);
  if (listed()) copy(active_.list().words(), kWord, kFoundActive);
  if (adaptive && !listed()) copy(prior_.evaluated(), kWord, kFoundEvaluated);
  if (mode_ == ActiveTiles::Mode::whole) return;
  copy(active_.busy(), kWord, kFoundBusy);
  copy(guide_.statistics(), 2 * kVec4, kFoundStatistics);
  copy(prior_.kept_statistics(), 2 * kVec4, kFoundKept);
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
  const auto count = [&](uint64_t slot) { return std::bit_cast<uint32_t>(found[4 * slot]); };
  findings.tiles_active = of.stats.listed ? count(kFoundActive) : of.stats.tiles;
  findings.tiles_evaluated = of.stats.listed ? findings.tiles_active
                             : of.adaptive   ? count(kFoundEvaluated)
                                             : of.stats.tiles;
  return findings;
}

}  // namespace inverse
