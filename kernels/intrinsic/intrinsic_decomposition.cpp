// SPDX-License-Identifier: LGPL-2.1-or-later
#include "intrinsic_decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "kernels/gpu/reduce.hpp"

namespace inverse {
namespace {

/// The parameters that the solution depends on: without those that only set the amount of work.
IntrinsicDecomposition::Params problem_of(IntrinsicDecomposition::Params params) {
  const IntrinsicDecomposition::Params defaults;
  params.cycles = defaults.cycles;
  params.warm_cycles = defaults.warm_cycles;
  params.tolerances = {};
  return params;
}

/// What a report reads back; the shaders that write it say what each number is.
struct Numbers {
  std::array<float, 4> progress, cut_decision, scale, binding, gates, slope;
  uint32_t evaluated;
  std::array<std::array<float, 4>, kMaxStrokes> strokes;
};

}  // namespace

IntrinsicDecomposition::IntrinsicDecomposition(std::shared_ptr<gpu::Device> device, Extent extent)
    : device_(std::move(device)),
      extent_(extent),
      planes_(device_, extent),
      guide_(device_, extent),
      strokes_(device_, extent),
      depth_cue_(device_, extent),
      prior_(device_, extent),
      recall_(device_, guide_.cell_extent()),
      anchor_(device_, extent),
      bins_(device_, guide_.cell_extent()),
      multigrid_(device_, extent),
      scale_(device_, guide_.cell_extent()),
      terms_kernel_(device_),
      anchored_terms_kernel_(device_, {.anchored = true}),
      measuring_terms_kernel_(device_, {.anchored = true, .measure = true}),
      assemble_(device_),
      anchored_assemble_(device_, {.anchored = true}),
      layers_(device_),
      anchored_layers_(device_, {.anchored = true}),
      colored_layers_(device_, {.colored = true}),
      anchored_colored_layers_(device_, {.anchored = true, .colored = true}),
      warm_start_(device_),
      total_(device_) {
  const auto buffer = [&](uint64_t count) {
    return gpu::Buffer::create(device_, gpu::Element::vec4, count);
  };
  const uint64_t cell_packs = pack4_count(guide_.cell_extent());
  flux_ = buffer(pack4_count(extent) * EdgePrior::kFluxStride);
  value_ = buffer(cell_packs * EdgePrior::kValueStride);
  terms_ = buffer(cell_packs * Multigrid::kTermsStride);
  start_ = buffer(cell_packs * TemporalAnchor::kStartStride);
  gate_sums_ = buffer(gpu::partial_count(*measuring_terms_kernel_.kernel(), line_of(cell_packs)));
  gate_total_ = buffer(1);
}

void IntrinsicDecomposition::assemble(gpu::Commands& commands, const TemporalAnchor::Params& params,
                                      const KnownReflectance* known) {
  if (plan_.history) anchor_.record(commands, guide_, params, continues_);
  if (plan_.measures_gate && !cleared_) {
    commands.fill(gate_sums_);
    cleared_ = true;
  }
  const Extent cells = guide_.cell_extent();
  const gpu::BufferPtr& value =
      known ? recall_.record(commands, guide_, value_, scale_.value(), *known) : value_;
  commands.dispatch(plan_.measures_gate ? measuring_terms_kernel_
                    : plan_.history     ? anchored_terms_kernel_
                                        : terms_kernel_,
                    {.value = value,
                     .cells = guide_.cells(),
                     .mismatch = anchor_.mismatch(),
                     .tiles = anchor_.tiles(),
                     .cut_decision = anchor_.cut_decision(),
                     .before = anchor_.kept(),
                     .means = multigrid_.cell_means(),
                     .correction = multigrid_.cell_correction(),
                     .terms = terms_,
                     .start = start_,
                     .source_term = multigrid_.cell_source_term(),
                     .sums = gate_sums_},
                    {.size = cells,
                     .anchor = plan_.compares_pixels ? params.anchor_weight : 0,
                     .frames = params.anchor_frames,
                     .motion = 1 / params.anchor_motion,
                     .hold = params.hold,
                     .light = 1 / params.hold_light},
                    line_of(pack4_count(cells)));
  if (plan_.measures_gate)
    commands.dispatch(total_, {.sums = gate_sums_, .total = gate_total_},
                      {.count = static_cast<uint32_t>(gate_sums_->count())}, {});
  commands.dispatch(plan_.compares_pixels ? anchored_assemble_ : assemble_,
                    {.flux = flux_,
                     .start = start_,
                     .level0 = guide_.level0(),
                     .source_term = multigrid_.cell_source_term(),
                     .memory = anchor_.memory(),
                     .last_shading = multigrid_.field(),
                     .system = multigrid_.system(),
                     .shading = gpu::aliased(multigrid_.field()),
                     .now = anchor_.now()},
                    {.size = extent_}, line_of(pack4_count(extent_)));
  commands.stage("assemble");
}

void IntrinsicDecomposition::solve(gpu::Commands& commands, const Params& params) {
  Multigrid::Params multigrid = params.multigrid;
  // A single cycle has none to be combined with: what it overshoots, frames after it overshoot too.
  if (plan_.cycles == 1) multigrid.slowest = 0;
  multigrid_.record_operators(commands, multigrid);
  bins_.record_weights(commands, guide_, terms_,
                       plan_.bins ? EdgePrior::max_chroma() * params.prior.chroma_weight : 0);
  commands.stage("operators");
  const ChromaBins::State state{.terms = terms_,
                                .means = multigrid_.cell_means(),
                                .correction = multigrid_.cell_correction(),
                                .far = multigrid_.cell_residual(),
                                .system = multigrid_.cell_system(),
                                .source_term = multigrid_.cell_source_term()};
  for (uint32_t cycle = 0; cycle < plan_.cycles; ++cycle)
    multigrid_.record_cycle(
        commands, multigrid, cycle,
        {.measured = plan_.stops() || cycle + 1 == plan_.cycles,
         .last = cycle + 1 == plan_.cycles,
         .conditional = plan_.stops() && cycle > 0,
         .tolerance = plan_.cycle_tolerance},
        [&] { bins_.record(commands, guide_, state); },
        [&] { bins_.record_source_term(commands, state, plan_.measures_bins); });
}

void IntrinsicDecomposition::make_plan(const Params& params, const FrameInfo& info) {
  // Of the last frame that is sure to be done, or this one could not begin.
  std::optional<Planner::Found> found;
  if (recorded_ >= reports_.size()) found = findings(recorded_ - reports_.size());
  const Params problem = problem_of(params);
  if (!has_history_ || other_strokes_ || depth_cue_.changed() || problem != params_)
    planner_.restart();
  params_ = problem;
  if (!start_layers_) continues_ = plan_.history;
  plan_ = planner_.next(
      {.adaptive = params.adaptive,
       .chroma = params.prior.chroma_weight > 0,
       .anchor = params.anchor.anchor_weight > 0,
       .tolerances = params.tolerances,
       .cycles = params.cycles,
       // What moves begins far from its solution, which strokes must not show.
       .warm_cycles = strokes_.mask().moves() ? std::max(params.warm_cycles, params.cycles)
                                              : params.warm_cycles},
      {.history = has_history_ && !other_strokes_,
       .warm_start = start_layers_ != nullptr,
       .repeated = info.repeated},
      found);
}

Layers IntrinsicDecomposition::record(gpu::Commands& commands, const PlanePtr& input,
                                      const Params& params, const FrameInfo& info) {
  if (info.reset) reset();
  take_strokes(commands, input, info);
  depth_cue_.set(info.known, has_history_);
  make_plan(params, info);
  if (info.light) info.light->record_move(commands);
  guide_.record(commands, input->buffer, info.light ? info.light->state() : nullptr);
  commands.stage("guide");
  if (start_layers_) start_from_layers(commands, input);
  evaluate_edges(commands, params);
  assemble(commands, params.anchor, info.known);
  solve(commands, params);
  strokes_.record_residuals(commands, guide_, multigrid_.field());
  find_scale(commands, params, info.light);
  const PlanePtr slope = info.light ? info.light->record_slope(commands, scale_.value()) : nullptr;
  const PlanePtr intrinsic = write_layers(commands, input, params, slope);
  record_report(commands, params, slope);
  commands.stage("layers");
  if (strokes_.mask().unfilled() || (strokes_.mask().fills() && strokes_.mask().moves()))
    before_ = {input, intrinsic};
  has_history_ = true;
  start_layers_.reset();
  commands.keep(input);
  commands.keep(intrinsic);
  if (slope) commands.keep(slope);
  return intrinsic_layers(input, intrinsic, slope);
}

void IntrinsicDecomposition::take_strokes(gpu::Commands& commands, const PlanePtr& input,
                                          const FrameInfo& info) {
  const StrokeMask& mask = strokes_.mask();
  const StrokeTracker* tracker = info.strokes ? info.tracker : nullptr;
  const SeenStrokes* seen = info.strokes ? info.seen : nullptr;
  StrokeMask::Reflectance reflectance;
  if (before_.intrinsic) {
    reflectance.reflectance = before_.intrinsic->buffer;
    if (mask.moves()) {
      reflectance.frame_before = before_.input->buffer;
      reflectance.frame = input->buffer;
    }
  }
  other_strokes_ = info.strokes != mask.list() || tracker != mask.tracker();
  if (other_strokes_) {
    strokes_.set(commands, info.strokes, {tracker, seen});
  } else if (mask.unfilled()) {
    strokes_.fill(commands, reflectance, seen);
    other_strokes_ = true;
  } else if (mask.moves() && !strokes_.empty()) {
    strokes_.follow(commands, reflectance, seen);
  }
  if (before_.intrinsic) {
    commands.keep(before_.input);
    commands.keep(before_.intrinsic);
  }
  before_ = {};
  if (!strokes_.empty()) commands.stage("strokes");
}

EdgePrior::Target IntrinsicDecomposition::prior_target() {
  return {.system = multigrid_.system(),
          .flux = flux_,
          .value = value_,
          .strokes = strokes_.empty() ? nullptr : &strokes_,
          .depth = depth_cue_.empty() ? nullptr : &depth_cue_};
}

void IntrinsicDecomposition::evaluate_edges(gpu::Commands& commands, const Params& params) {
  EdgePrior::Params prior = params.prior;
  if (!plan_.bins) prior.chroma_weight = 0;
  const EdgePrior::Target target = prior_target();
  if (!has_history_ || other_strokes_ || depth_cue_.changed()) prior_.reset();
  switch (plan_.edges) {
    case Plan::Edges::compare:
      prior_.record_changes(commands, guide_, target, prior, params.tolerances.edge);
      break;
    case Plan::Edges::all_save:
    case Plan::Edges::all:
      prior_.record(commands, guide_, target, prior, plan_.edges == Plan::Edges::all_save);
      break;
  }
  commands.stage("prior");
}

void IntrinsicDecomposition::find_scale(gpu::Commands& commands, const Params& params,
                                        const SceneLight* light) {
  using History = OutputScale::History;
  scale_.record(commands, guide_, multigrid_.field(), anchor_.cut_decision(),
                plan_.history                   ? History::decided
                : has_history_ || start_layers_ ? History::taken
                                                : History::none,
                params.scale, light ? light->state() : nullptr);
}

PlanePtr IntrinsicDecomposition::write_layers(gpu::Commands& commands, const PlanePtr& input,
                                              const Params& params, const PlanePtr& slope) {
  PlanePtr intrinsic = planes_.acquire();
  const auto& gray = plan_.compares_pixels ? anchored_layers_ : layers_;
  const auto& colored = plan_.compares_pixels ? anchored_colored_layers_ : colored_layers_;
  commands.dispatch(slope ? colored : gray,
                    {.frame = input->buffer,
                     .cells = guide_.cells(),
                     .guide_coarse = guide_.guide_coarse(),
                     .scale = scale_.value(),
                     .start = start_,
                     .before = anchor_.memory(),
                     .now = anchor_.now(),
                     .shading = multigrid_.field(),
                     .memory = gpu::aliased(anchor_.now()),
                     .new_shading = gpu::aliased(multigrid_.field()),
                     .cell_history = anchor_.kept(),
                     .intrinsic = intrinsic->buffer,
                     .slope = slope ? slope->buffer : scale_.value()},
                    {.size = extent_, .texture = 1 / params.anchor.hold_texture},
                    line_of(guide_.cell_extent().pixels()));
  anchor_.advance();
  return intrinsic;
}

void IntrinsicDecomposition::continue_from(gpu::Commands& commands,
                                           const IntrinsicDecomposition& other,
                                           PlanePtr intrinsic) {
  reset();
  scale_.take(commands, other.scale_);
  commands.copy(other.anchor_.cut_decision(), anchor_.cut_decision(),
                anchor_.cut_decision()->bytes());
  continues_ = other.plan_.history;
  start_layers_ = std::move(intrinsic);
}

void IntrinsicDecomposition::start_from_layers(gpu::Commands& commands, const PlanePtr& input) {
  commands.dispatch(warm_start_,
                    {.frame = input->buffer,
                     .intrinsic = start_layers_->buffer,
                     .cells = guide_.cells(),
                     .guide_coarse = guide_.guide_coarse(),
                     .scale = scale_.value(),
                     .level0 = guide_.level0(),
                     .memory = anchor_.memory(),
                     .shading = multigrid_.field(),
                     .kept = anchor_.kept(),
                     .means = multigrid_.cell_means(),
                     .correction = multigrid_.cell_correction(),
                     .source_term = multigrid_.cell_source_term()},
                    {.size = extent_}, line_of(pack4_count(guide_.cell_extent())));
  commands.keep(start_layers_);
  commands.stage("warm-start");
}

void IntrinsicDecomposition::record_report(gpu::Commands& commands, const Params& params,
                                           const PlanePtr& slope) {
  Report& report = reports_[recorded_++];
  report.colored = slope != nullptr;
  report.strokes = strokes_.count();
  report.stats = {plan_,
                  multigrid_.depth(),
                  prior_.tiles(),
                  params.tolerances,
                  params.prior.network,
                  prior_.network_age(),
                  prior_.network_runs()};
  if (!report.found)
    report.found = gpu::Buffer::create(device_, gpu::Element::word,
                                       sizeof(Numbers) / sizeof(uint32_t), gpu::Memory::readback);
  std::vector<gpu::Commands::CopyPart> parts;
  const auto copy = [&](const gpu::BufferPtr& from, auto Numbers::*to) {
    static constexpr Numbers numbers{};
    const auto offset = reinterpret_cast<const std::byte*>(&(numbers.*to)) -
                        reinterpret_cast<const std::byte*>(&numbers);
    parts.push_back({.source = from,
                     .bytes = sizeof(numbers.*to),
                     .target_offset = static_cast<uint64_t>(offset)});
  };
  copy(multigrid_.progress(), &Numbers::progress);
  if (plan_.history) copy(anchor_.cut_decision(), &Numbers::cut_decision);
  copy(scale_.value(), &Numbers::scale);
  if (slope) copy(slope->buffer, &Numbers::slope);
  if (plan_.edges == Plan::Edges::compare) copy(prior_.evaluated(), &Numbers::evaluated);
  if (plan_.measures_bins) copy(bins_.binding(), &Numbers::binding);
  if (plan_.measures_gate) copy(gate_total_, &Numbers::gates);
  if (!strokes_.empty())
    parts.push_back({.source = strokes_.residuals(),
                     .bytes = strokes_.count() * sizeof(Numbers::strokes[0]),
                     .target_offset = offsetof(Numbers, strokes)});
  commands.copy(parts, report.found);
}

IntrinsicDecomposition::Findings IntrinsicDecomposition::findings(uint64_t frame) const {
  const Report& of = report(frame);
  const Plan& plan = of.stats.plan;
  const Numbers& numbers = *of.found->map_as<Numbers>();
  using Progress = shaders::intrinsic_multigrid_convergence;
  using Cut = shaders::intrinsic_temporal_cut_decision;
  using Bins = shaders::intrinsic_chroma_source_term;
  Findings findings;
  findings.plan = plan;
  findings.tiles = of.stats.tiles;
  findings.change = std::sqrt(numbers.progress[Progress::PROGRESS_CHANGE]);
  findings.cycles = plan.stops()
                        ? static_cast<uint32_t>(numbers.progress[Progress::PROGRESS_CYCLES])
                        : plan.cycles;
  if (plan.history) {
    findings.mismatch = numbers.cut_decision[Cut::CUT_MISMATCH];
    findings.cut = numbers.cut_decision[Cut::CUT_ANCHORED] == 0;
  }
  findings.scale = numbers.scale[0];
  for (size_t i = 0; i < of.strokes; ++i)
    findings.strokes.push_back(Strokes::rms_of(numbers.strokes[i]));
  if (of.colored) {
    using Light = shaders::intrinsic_light_color_white;
    findings.slope = numbers.slope[Light::SLOPE_K];
    findings.slope_confidence = numbers.slope[Light::SLOPE_CONFIDENCE];
    findings.slope_found =
        static_cast<SceneLight::Did>(static_cast<uint32_t>(numbers.slope[Light::SLOPE_DONE]));
  }
  if (plan.measures_bins)
    findings.binding = std::sqrt(numbers.binding[Bins::BINDING_EFFECT] /
                                 std::max(numbers.binding[Bins::BINDING_WEIGHT], 1e-20F));
  if (plan.measures_gate)
    findings.gate = std::sqrt(numbers.gates[shaders::intrinsic_energy_cell_terms::GATE_SQUARES] /
                              static_cast<float>(guide_.cell_extent().pixels()));
  findings.tiles_evaluated =
      plan.edges == Plan::Edges::compare ? numbers.evaluated : of.stats.tiles;
  return findings;
}

}  // namespace inverse
