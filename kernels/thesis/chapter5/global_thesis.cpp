// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_thesis.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "global_thesis_programs.hpp"
#include "kernels/gpu/reduce.hpp"
#include "kernels/thesis/chapter5/colors/refinement.hpp"
#include "kernels/thesis/shared/sample_frames.hpp"

namespace inverse {
using namespace global_thesis;
namespace {

// Share of its history that the palette drops each frame for an absent color: gone within two
// seconds.
constexpr float kFade = 0.3f;
constexpr auto kCells = static_cast<uint32_t>(shaders::thesis_chapter5_setup_cells::kAcross *
                                              shaders::thesis_chapter5_setup_cells::kAcross);

}  // namespace

GlobalThesis::GlobalThesis(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      palette_(device),
      pool_(device, extent),
      bases_pool_(device, {kMaxBases, 1}) {
  const auto planes = [&](uint64_t count) {
    return gpu::Buffer::create(device, gpu::Element::vec4, count * extent.pixels());
  };
  for (auto* buffer : {&image_, &chroma_, &targets_, &features_, &sources_, &constant_sources_})
    *buffer = planes(1);
  for (auto* buffer : {&nodes_, &pixel_products_})
    *buffer = planes(2);  // also what four layers need
  max_layers_ = max_layers(*device, extent);
  scalars_ =
      gpu::Buffer::create(device, gpu::Element::scalar, shaders::thesis_shared_scalars::CG_SIZE);
  search_ = gpu::Buffer::create(device, gpu::Element::scalar, Search::SEARCH_SIZE);
  rescale_ = gpu::Buffer::create(device, gpu::Element::word, 1);
  colors_readback_.buffer =
      gpu::Buffer::create(device, gpu::Element::vec4, kColors, gpu::Memory::readback);
  set_params({});
}

int GlobalThesis::max_layers(const gpu::Device& device, Extent extent) {
  const uint64_t plane = 16 * extent.pixels();
  const uint64_t bytes =
      std::min(device.limits().storage_buffer_bytes, 16 * device.limits().texel_elements);
  const uint64_t planes = std::min<uint64_t>(bytes / plane, 1 + kIndirectPlanes);
  return 4 * (static_cast<int>(planes) - 1);
}

void GlobalThesis::set_params(const Params& params) {
  Params p = params;
  for (float* weight : {&p.lambda_data, &p.lambda_clustering, &p.lambda_r_sparsity,
                        &p.lambda_r_consistency, &p.lambda_monochrome, &p.lambda_i_sparsity,
                        &p.lambda_smoothness, &p.lambda_non_negativity}) {
    *weight = std::clamp(*weight, 0.0f, 1e6f);
  }
  p.lambda_ir = std::clamp(p.lambda_ir, 1e-3f, 1e9f);
  p.lambda_cr = std::clamp(p.lambda_cr, 0.0f, 1e9f);
  for (float* share : {&p.w_intensity, &p.indirect_start, &p.refine_tolerance, &p.cut_chroma})
    *share = std::clamp(*share, 0.0f, 1.0f);
  for (float* floor : {&p.log_floor, &p.chroma_floor}) *floor = std::clamp(*floor, 1e-6f, 0.5f);
  for (float* floor : {&p.epsilon, &p.epsilon_r}) *floor = std::clamp(*floor, 1e-4f, 1.0f);
  for (float* distance : {&p.tau_cc, &p.tau_merge, &p.tau_neutral})
    *distance = std::clamp(*distance, 0.0f, 3.0f);
  p.p = std::clamp(p.p, 0.0f, 2.0f);
  p.alpha_sr = std::clamp(p.alpha_sr, 0.0f, 1e4f);
  p.clusters = std::clamp(p.clusters, 1, max_layers_);
  p.steps = std::clamp(p.steps, 1, 64);
  p.pcg_iterations = std::clamp(p.pcg_iterations, 1, 256);
  p.samples = std::clamp(p.samples, 0, 64);
  p.keyframes = std::clamp(p.keyframes, 0, 5);
  p.keyframe_spacing = std::clamp(p.keyframe_spacing, 1, 1000);
  p.refine_rounds = std::clamp(p.refine_rounds, 0, 100);
  const bool rebuild = frames_.empty() || p.keyframes != params_.keyframes;
  if ((p.p == 1) != (params_.p == 1)) kernels_ = {};
  params_ = p;

  Palette::Params palette = palette_.params();
  palette.clusters = p.clusters;
  palette.tau_cc = p.tau_merge;
  palette.fade = kFade;
  palette.apart = p.tau_merge;
  palette.chroma_floor = p.chroma_floor;
  palette.seed = p.seed;
  palette_.set_params(palette);
  if (rebuild) {
    const auto slots = static_cast<uint64_t>(p.keyframes) + 1;
    hold_frames(sample_slots_per_buffer(*device_, slots, extent_.pixels()));
  }
  const uint64_t entries = 2 * (p.trace ? static_cast<uint64_t>(p.steps) + 1 : 1);
  if (trace_ && trace_->count() >= entries) return;
  trace_ = gpu::Buffer::create(device_, gpu::Element::vec4, entries);
  for (Readback& readback : readback_) {
    readback = {};
    readback.buffer =
        gpu::Buffer::create(device_, gpu::Element::vec4, kTraceAt + entries, gpu::Memory::readback);
    readback.table = gpu::Buffer::create(device_, gpu::Element::vec4, BaseColors::kTableEntries,
                                         gpu::Memory::upload);
  }
}

/// Allocates sample frames, and discards those before.
void GlobalThesis::hold_frames(int slots_per_buffer) {
  const auto slots = static_cast<uint64_t>(params_.keyframes) + 1;
  const auto per_buffer = std::min(static_cast<uint64_t>(slots_per_buffer), slots);
  if (slots_ != slots_per_buffer) kernels_ = {};
  slots_ = slots_per_buffer;
  frames_.clear();
  for (uint64_t first = 0; first < slots; first += per_buffer) {
    frames_.push_back(
        gpu::Buffer::create(device_, gpu::Element::vec4, per_buffer * extent_.pixels()));
  }
  stored_keyframes_ = 0;
  since_reset_ = 0;
}

/// All but the base colors.
void GlobalThesis::forget_frames() {
  palette_.reset();
  since_reset_ = 0;
  stored_keyframes_ = 0;
  rounds_ = 0;
  system_pending_ = false;
  has_state_ = false;
  compared_ = false;
  ++epoch_;
}

void GlobalThesis::reset() {
  forget_frames();
  colors_.reset();
  scene_since_ = 0;
}

void GlobalThesis::cut() {
  forget_frames();
  if (colors_.given()) return;
  colors_.loosen();
  scene_since_ = UINT64_MAX;
}

void GlobalThesis::set_base_colors(std::span<const Rgb> colors) {
  if (colors.size() > static_cast<size_t>(max_layers_))
    throw Error(ErrorKind::limit, "the device can bind the layers of " +
                                      std::to_string(max_layers_) + " base colors at " +
                                      std::to_string(extent_.width) + "x" +
                                      std::to_string(extent_.height) + ", and " +
                                      std::to_string(colors.size()) + " were given");
  colors_.set(colors);
  rounds_ = 0;
}

void GlobalThesis::set_base_colors(const BaseColors& colors) {
  colors_ = colors;
  colors_.hold();
  has_state_ = false;
}

/// Allocates fields for `groups` planes of indirect layers.
void GlobalThesis::hold_fields(int groups) {
  if (groups <= held_groups_) return;
  const uint64_t entries = (static_cast<uint64_t>(groups) + 1) * extent_.pixels();
  for (auto* buffer :
       {&states_[0], &states_[1], &directions_, &preconditioned_, &products_, &diagonals_}) {
    *buffer = gpu::Buffer::create(device_, gpu::Element::vec4, entries);
  }
  const Kernels& at = kernels(groups);
  const auto planes = static_cast<uint32_t>(groups) + 1;
  // The tallest dispatch of those that sum up.
  partials_ = gpu::Buffer::create(
      device_, gpu::Element::vec4,
      gpu::partial_count(*at.reweight.kernel(), {extent_.width, extent_.height + planes}));
  held_groups_ = groups;
  has_state_ = false;
}

GlobalThesis::Push GlobalThesis::push_for() const {
  const Params& p = params_;
  const bool consistent = p.irls == Params::Irls::consistent;
  const int ring = std::max(p.keyframes, 1);
  const float threshold = p.tau_cc * 1365.0f;
  return {.size = extent_,
          .count = 0,
          .mode = 0,
          .samples = p.lambda_r_consistency > 0 ? p.samples : 0,
          .frames = 1 + std::min(stored_keyframes_, p.keyframes),
          .ring_start = stored_keyframes_ > p.keyframes ? stored_keyframes_ % ring : 0,
          .ring_capacity = ring,
          .slot = 0,
          .stream = 0,
          .seed = p.seed + (p.resample ? since_reset_ * 0x9E3779B9u : 0u),
          .centers = colors_.slots(),
          .layers = colors_.layers(),
          .lambda_data = p.lambda_data,
          .lambda_clustering = p.lambda_clustering,
          .lambda_r_sparsity = p.lambda_r_sparsity,
          .lambda_r_consistency = p.lambda_r_consistency,
          .lambda_monochrome = p.lambda_monochrome,
          .lambda_i_sparsity = p.lambda_i_sparsity,
          .lambda_smoothness = p.lambda_smoothness,
          .lambda_non_negativity = p.lambda_non_negativity,
          .p = p.p,
          .irls_r = consistent ? 0.5f * p.p : 1.0f,
          .irls_light = consistent ? 0.5f : 1.0f,
          .alpha_sr = p.alpha_sr,
          .w_intensity = p.w_intensity,
          .sample_threshold = threshold * threshold,
          .epsilon = p.epsilon,
          .epsilon_r = p.epsilon_r,
          .log_floor = p.log_floor,
          .chroma_floor = p.chroma_floor,
          .indirect_start = p.indirect_start};
}

void GlobalThesis::clear(Readback& readback) const {
  readback.stats = {};
  readback.plan = {};
  readback.collected = false;
  readback.epoch = epoch_;
}

GlobalThesis::Plan GlobalThesis::plan_frame(const Hints& hints) const {
  Plan plan;
  plan.warm = params_.warm_start && has_state_ && state_order_ == colors_.order();
  plan.measure_change = params_.cut_chroma > 0;
  plan.has_change = plan.measure_change && compared_;
  plan.regions = hints.regions || hints.fixed_regions;
  plan.score = plan.regions && hints.scored_region > 0;
  plan.search = params_.line_search;
  // Not while a system is under way, nor with colors of the scene before.
  plan.refine = refining() && !system_pending_ && scene_since_ != UINT64_MAX;
  plan.store_keyframe =
      params_.keyframes > 0 && since_reset_ % static_cast<uint32_t>(params_.keyframe_spacing) == 0;
  return plan;
}

/// The frame's plan and statistics, in `current_`, and the fields for its layers.
void GlobalThesis::begin(gpu::Commands& commands, const Hints& hints) {
  groups_ = (colors_.layers() + 3) / 4;
  const bool fresh = groups_ > held_groups_;
  hold_fields(groups_);
  at_ = &kernels(groups_);
  // Sums leave some slots untouched, and the first direction is multiplied by zero.
  if (fresh) commands.fill(partials_);
  current_ = &readback_[recorded_++];
  if (current_->plan.refine && !current_->collected) system_pending_ = false;  // not collected
  clear(*current_);
  current_->plan = plan_frame(hints);
  Stats& stats = current_->stats;
  stats.layers = colors_.layers();
  stats.colors = static_cast<int>(colors_.colors().size());
  stats.steps = params_.steps;
  stats.pcg_iterations = params_.pcg_iterations;
  stats.keyframes = std::min(stored_keyframes_, params_.keyframes);
  stats.warm = current_->plan.warm;
  stats.refining = current_->plan.refine;
  colors_.write_table(current_->table->map_as<float>());
}

/// The change of chroma from the frame before.
void GlobalThesis::measure_change(gpu::Commands& commands, uint64_t number) {
  if (!cells_) {
    cells_ = gpu::Buffer::create(device_, gpu::Element::vec4, 2 * kCells);
    change_ = gpu::Buffer::create(device_, gpu::Element::vec4, 1);
    commands.fill(cells_);
  }
  Push push = push_for();
  push.slot = static_cast<int32_t>(number % 2);
  push.count = static_cast<int32_t>(kCells);
  commands.dispatch(kernels(0).cells, {.chroma = chroma_, .image = image_, .cells = cells_}, push,
                    {kCells});
  commands.dispatch(kernels(0).change, {.cells = cells_, .change = change_}, push,
                    {gpu::kOneGroup});
  commands.copy(change_, current_->buffer, 16, 0, 16 * kChangeAt);
}

/// The image and its palette.
void GlobalThesis::prepare(gpu::Commands& commands, const Plane& frame) {
  commands.dispatch(kernels(0).sanitize,
                    {.frame = frame.buffer, .image = image_, .chroma = chroma_}, push_for(),
                    {extent_.width, extent_.height});
  if (!colors_.given()) palette_.record_update(commands, {extent_, chroma_});
  commands.copy(palette_.colors(), current_->buffer, 16 * kColors, 0, 16 * kColorsAt);
}

void GlobalThesis::check_size(const Plane& frame) const {
  if (frame.extent != extent_)
    throw Error(ErrorKind::internal, "the decomposition was made for another frame size");
}

void GlobalThesis::record_colors(gpu::Commands& commands, const Plane& frame) {
  check_size(frame);
  current_ = &colors_readback_;
  clear(*current_);
  prepare(commands, frame);
  commands.stage("clusters");
}

void GlobalThesis::collect_colors() {
  if (std::exchange(colors_readback_.collected, true) || colors_readback_.epoch != epoch_) return;
  const auto* values = colors_readback_.buffer->map_as<float>();
  colors_.update(Palette::read(values + 4 * kColorsAt, params_.clusters), params_.tau_neutral);
}

/// What the solver is given: features, targets and the constant source terms of every pixel.
void GlobalThesis::set_up(gpu::Commands& commands, const Hints& hints) {
  const gpu::Items pixels{extent_.width, extent_.height};
  Push push = push_for();
  commands.dispatch(at_->setup, {.image = image_, .table = current_->table, .features = features_},
                    push, pixels);
  if (hints.regions) hints.regions->record(commands, {extent_, features_});
  using Targets = shaders::thesis_chapter5_setup_targets;
  push.mode = current_->plan.regions ? Targets::kRegions : Targets::kClusters;
  commands.dispatch(at_->targets,
                    {.table = current_->table,
                     .features = features_,
                     .regions = current_->plan.regions ? hints.buffer() : features_,
                     .targets = targets_},
                    push, pixels);
  if (!current_->plan.warm) {
    commands.dispatch(at_->start,
                      {.table = current_->table,
                       .image = image_,
                       .targets = targets_,
                       .features = features_,
                       .state = states_[current_state_]},
                      push, pixels);
  }
  if (push.frames == 1) push.samples = 0;  // nothing but clusters
  dispatch_with_frames(commands, at_->sample_past, frames_,
                       {.features = features_, .targets = targets_, .sources = constant_sources_},
                       push, pixels);
  commands.stage("setup");
}

uint64_t GlobalThesis::record(gpu::Commands& commands, const Plane& frame, Layers& layers,
                              const Hints& hints) {
  check_size(frame);
  const uint64_t number = recorded_;
  begin(commands, hints);
  const Plan& plan = current_->plan;
  prepare(commands, frame);
  if (plan.measure_change) measure_change(commands, number);
  compared_ = plan.measure_change;
  commands.stage("clusters");
  set_up(commands, hints);
  solve(commands);
  if (plan.store_keyframe) pack(commands, 1 + stored_keyframes_++ % params_.keyframes);
  ++since_reset_;
  commands.stage("steps");
  if (plan.refine) record_refinement(commands);
  if (plan.score) score_region(commands, hints);
  write_layers(commands, layers);
  if (!current_->stats.energy.empty())
    commands.copy(trace_, current_->buffer, 32 * current_->stats.energy.size(), 0, 16 * kTraceAt);
  commands.stage("layers");
  return number;
}

void GlobalThesis::collect(uint64_t frame) {
  if (frame >= recorded_ || frame + readback_.size() < recorded_) return;
  Readback& readback = readback_[frame];
  if (readback.collected) return;
  readback.collected = true;
  if (readback.plan.refine) system_pending_ = false;
  if (readback.epoch != epoch_) return;  // from before a reset or cut
  const auto* values = readback.buffer->map_as<float>();
  const bool compared = readback.plan.has_change && params_.cut_chroma > 0;
  if (compared && values[4 * kChangeAt] > params_.cut_chroma) {
    readback.stats.cut = true;
    cut();
    return;
  }
  if (readback.plan.refine && readback.version == colors_.version()) {
    const size_t layers = readback.colors.size();
    const auto delta = solve_refinement({values + 4 * kSystemAt, 4 * layers * (layers + 1)},
                                        readback.colors, readback.initial, params_.lambda_data,
                                        params_.lambda_ir, params_.lambda_cr);
    const float change = colors_.refine(delta);
    rounds_ = change < params_.refine_tolerance ? params_.refine_rounds : rounds_ + 1;
  }
  if (frame < collected_) return;  // a later frame was collected
  collected_ = frame + 1;
  colors_.update(Palette::read(values + 4 * kColorsAt, params_.clusters), params_.tau_neutral);
  if (scene_since_ == UINT64_MAX) scene_since_ = recorded_;
}

GlobalThesis::Stats GlobalThesis::stats(uint64_t frame) const {
  if (recorded_ == 0) return {};
  if (frame >= recorded_ || frame + readback_.size() < recorded_) {
    throw Error(ErrorKind::internal, "statistics are kept for the last three frames only");
  }
  const Readback& readback = readback_[frame];
  const auto* values = readback.buffer->map_as<float>();
  Stats stats = readback.stats;
  if (readback.plan.has_change) stats.change = values[4 * kChangeAt];
  if (readback.plan.search)
    stats.shortened = static_cast<int>(values[4 * kSearchAt + Search::SEARCH_SHORTENED]);
  if (readback.plan.score) {
    stats.score = values[4 * kScoreAt];
    stats.region = values[4 * kScoreAt + 1];
  }
  for (size_t n = 0; n < stats.energy.size(); ++n) {
    std::memcpy(&stats.energy[n].data, values + 4 * (kTraceAt + 2 * n), 8 * sizeof(float));
  }
  return stats;
}

uint64_t GlobalThesis::bytes_per_pixel(int layers, int keyframes) {
  const auto fields = static_cast<uint64_t>(layers + 3) / 4 + 1;
  // Six fields; image, chroma, targets, features, two of source terms, two each of nodes and pixel
  // products; samples.
  return 16 * (6 * fields + 10 + static_cast<uint64_t>(keyframes) + 1);
}

}  // namespace inverse
