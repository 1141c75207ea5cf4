// SPDX-License-Identifier: LGPL-2.1-or-later
#include "thesis_decomposition.hpp"

#include <algorithm>

#include "kernels/gpu/reduce.hpp"
#include "kernels/image/pyramid.hpp"
#include "kernels/thesis/shared/sample_frames.hpp"

namespace inverse {
namespace {

constexpr int kBlock = 16;            // Schwarz
constexpr uint32_t kBlockGroup = 64;  // invocations that solve one block
constexpr uint32_t kStrip = shaders::thesis_chapter3_direction::kStrip;
using Scalars = shaders::thesis_shared_scalars;
/// The radical inverse of n in `base`, times the block size, rounded down.
int halton(int n, int base) {
  int digits = 0, denominator = 1;
  for (; n > 0; n /= base) {
    digits = digits * base + n % base;
    denominator *= base;
  }
  return kBlock * digits / denominator;
}

gpu::Items pixels_of(Extent extent) { return {extent.width, extent.height}; }
gpu::Items strips_of(Extent extent) { return {extent.width, (extent.height - 1) / kStrip + 1}; }

/// Cells of 4 x 4 pixels, on which the scale's points are followed.
constexpr Extent cells_of(Extent extent) {
  return {(extent.width + 3) / 4, (extent.height + 3) / 4};
}

}  // namespace

ThesisDecomposition::ThesisDecomposition(const std::shared_ptr<gpu::Device>& device, Extent extent)
    : device_(device),
      extent_(extent),
      palette_(device),
      scale_(device, cells_of(extent)),
      pool_(device, extent),
      sanitize_(device),
      downsample_(device),
      start_(device),
      prolong_(device),
      pack_(device),
      scalars_kernel_(device, {}, gpu::kOneGroup),
      total_(device, {}, gpu::kOneGroup),
      layers_(device),
      scale_cells_(device),
      strokes_(device),
      known_(device),
      target_scale_(gpu::Buffer::create(device, gpu::Element::vec4, 1)) {
  const auto plane = [&] {
    return gpu::Buffer::create(device, gpu::Element::vec4, extent.pixels());
  };
  for (auto* buffer : {&links_, &sources_, &constant_sources_, &edges_, &nodes_, &preconditioned_,
                       &products_, &clusters_, &directions_[0], &directions_[1]}) {
    *buffer = plane();
  }
  make_solvers();
  partials_ =
      gpu::Buffer::create(device, gpu::Element::vec4,
                          gpu::partial_count(*solver().direction.kernel(), strips_of(extent)));
  scalars_ = gpu::Buffer::create(device, gpu::Element::scalar, Scalars::CG_SIZE);
  set_params({});
}

void ThesisDecomposition::set_params(const Params& params) {
  Params p = params;
  for (float* weight : {&p.w_data, &p.w_reflectance, &p.w_shading, &p.w_chromaticity,
                        &p.w_non_local, &p.w_clustering}) {
    *weight = std::clamp(*weight, 0.0f, 1e6f);
  }
  for (float* share : {&p.w_intensity, &p.w_cs}) *share = std::clamp(*share, 0.0f, 1.0f);
  for (float* floor : {&p.log_floor, &p.chroma_floor}) *floor = std::clamp(*floor, 1e-6f, 0.5f);
  p.p = std::clamp(p.p, 0.0f, 2.0f);
  p.alpha_cs = std::clamp(p.alpha_cs, 0.0f, 1e4f);
  p.alpha_clustering = std::clamp(p.alpha_clustering, 0.0f, 1e3f);
  p.tau_cc = std::clamp(p.tau_cc, 0.0f, 3.0f);
  p.epsilon = std::clamp(p.epsilon, 1e-6f, 1.0f);
  p.residual_tolerance = std::clamp(p.residual_tolerance, 0.0f, 1.0f);
  p.levels = std::clamp(p.levels, 0, 12);
  p.irls_iterations = std::clamp(p.irls_iterations, 1, 64);
  p.pcg_iterations = std::clamp(p.pcg_iterations, 1, 256);
  p.samples = std::clamp(p.samples, 0, 64);
  p.keyframes = std::clamp(p.keyframes, 0, 5);
  p.keyframe_spacing = std::clamp(p.keyframe_spacing, 1, 1000);
  const bool other = p.formulation != params_.formulation;
  const bool rebuild = levels_.empty() || p.keyframes != params_.keyframes ||
                       thesis_levels(extent_, p.levels) != levels();
  params_ = p;
  if (other) make_solvers();
  Palette::Params palette = palette_.params();
  palette.tau_cc = p.tau_cc;
  palette.chroma_floor = p.chroma_floor;
  palette.seed = p.seed;
  palette_.set_params(palette);
  if (rebuild) build_levels();
  build_readback();
}

void ThesisDecomposition::make_solvers() {
  const int chapter = params_.formulation == Params::Formulation::chapter4 ? 4 : 3;
  for (const bool strokes : {false, true})
    solvers_[strokes] = {
        .setup = {device_, {.chapter = chapter}},
        .reweight = {device_, {.strokes = strokes, .chapter = chapter}},
        .direction = {device_, {.strokes = strokes, .chapter = chapter}},
        .update = {device_, {.chapter = chapter}},
        .schwarz = {device_, {.strokes = strokes, .chapter = chapter}, kBlockGroup},
        .energy = {device_, {.strokes = strokes, .chapter = chapter}}};
}

void ThesisDecomposition::set_strokes(ThesisStrokes strokes) { strokes_.set(std::move(strokes)); }

void ThesisDecomposition::build_levels() {
  levels_.clear();
  reset();
  Extent extent = extent_;
  for (int n = thesis_levels(extent_, params_.levels); n > 0; --n, extent = half_of(extent)) {
    Level level;
    level.extent = extent;
    const auto plane = [&](uint64_t planes) {
      return gpu::Buffer::create(device_, gpu::Element::vec4, planes * extent.pixels());
    };
    level.image = plane(1);
    level.solution = plane(1);
    const auto slots = static_cast<uint64_t>(params_.keyframes) + 1;
    level.slots = sample_slots_per_buffer(*device_, slots, extent.pixels());
    const auto per_buffer = std::min<uint64_t>(static_cast<uint64_t>(level.slots), slots);
    for (uint64_t first = 0; first < slots; first += per_buffer) {
      level.frames.push_back(plane(per_buffer));
    }
    level.sample = {device_, {.slots = level.slots}};
    level.sample_past = {device_, {.slots = level.slots}};
    level.energy_samples = {device_, {.slots = level.slots}};
    levels_.push_back(std::move(level));
  }
  std::vector<Extent> extents;
  for (const Level& level : levels_) extents.push_back(level.extent);
  strokes_.set_levels(extents);
  known_.set_levels(extents);
}

void ThesisDecomposition::reset() {
  palette_.reset();
  since_reset_ = 0;
  stored_keyframes_ = 0;
}

ThesisDecomposition::Push ThesisDecomposition::push_for(size_t level) const {
  const Params& p = params_;
  const int ring_capacity = std::max(p.keyframes, 1);
  const float threshold = p.tau_cc * 1365.0f;
  return {.size = levels_[level].extent,
          .other_size = {0, 0},
          .shift = {0, 0},
          .count = 0,
          .samples = p.w_non_local > 0 ? p.samples : 0,
          .frames = 1 + std::min(stored_keyframes_, p.keyframes),
          .ring_start = stored_keyframes_ > p.keyframes ? stored_keyframes_ % ring_capacity : 0,
          .ring_capacity = ring_capacity,
          .slot = 0,
          .stream = static_cast<uint32_t>(level),
          .seed = p.seed + (p.resample ? since_reset_ * 0x9E3779B9u : 0u),
          .w_data = p.w_data,
          .w_intensity = p.w_intensity,
          .w_reflectance = p.w_reflectance,
          .w_shading = p.w_shading,
          .w_chromaticity = p.w_chromaticity,
          .w_non_local = p.w_non_local,
          .w_clustering = level == 0 && current_->clustered ? p.w_clustering : 0,
          .w_known = known_.weight(),
          .w_cs = p.w_cs,
          .alpha_cs = p.alpha_cs,
          .alpha_clustering = p.alpha_clustering,
          .sample_threshold = threshold * threshold,
          .log_floor = p.log_floor,
          .chroma_floor = p.chroma_floor,
          .p = p.p,
          .epsilon2 = p.epsilon * p.epsilon,
          .irls_factor = p.irls == Params::Irls::consistent ? 0.5f * p.p : 1.0f};
}

void ThesisDecomposition::pack(gpu::Commands& commands, size_t level, int slot) {
  const Level& at = levels_[level];
  Push push = push_for(level);
  push.slot = slot % at.slots;
  commands.dispatch(pack_,
                    {.image = at.image,
                     .solution = at.solution,
                     .frames = at.frames[static_cast<size_t>(slot / at.slots)]},
                    push, pixels_of(at.extent));
}

Plane ThesisDecomposition::sample_frame(int level) const {
  const Level& at = levels_.at(static_cast<size_t>(level));
  return {at.extent, at.frames.front()};
}

void ThesisDecomposition::evaluate(gpu::Commands& commands, size_t level, int step) {
  const Level& at = levels_[level];
  Push push = push_for(level);
  commands.dispatch(solver().energy,
                    {.image = at.image,
                     .solution = at.solution,
                     .links = links_,
                     .partials = energy_partials_,
                     .stroke_mask = strokes_.mask(level),
                     .stroke_means = strokes_.means()},
                    push, pixels_of(at.extent));
  dispatch_with_frames(commands, at.energy_samples, at.frames,
                       {.image = at.image,
                        .clusters = clusters_,
                        .solution = at.solution,
                        .partials = sample_partials_,
                        .known_targets = known_.targets(level)},
                       push, pixels_of(at.extent));
  push.count =
      static_cast<int32_t>(gpu::partial_count(*solver().energy.kernel(), pixels_of(at.extent)));
  push.slot = static_cast<int32_t>(current_->energy.size());
  commands.dispatch(total_,
                    {.local = energy_partials_, .samples = sample_partials_, .trace = trace_}, push,
                    {gpu::kOneGroup});
  current_->energy.push_back({static_cast<int>(level), step, 0, 0, 0, 0});
}

void ThesisDecomposition::conjugate_gradients(gpu::Commands& commands, size_t level, bool first) {
  const Level& at = levels_[level];
  const Push push = push_for(level);
  const gpu::Items strips = strips_of(at.extent);
  const auto reduce = [&](int32_t mode) {
    commands.dispatch(
        scalars_kernel_, {.partials = partials_, .scalars = scalars_},
        {.count = static_cast<int32_t>(gpu::partial_count(*solver().direction.kernel(), strips)),
         .mode = mode,
         .first = first,
         .tolerance = params_.residual_tolerance},
        {gpu::kOneGroup});
  };
  reduce(Scalars::kSystem);
  const auto iterate = [&](int k) {
    const auto& previous = directions_[static_cast<size_t>(k + 1) % 2];
    const auto& direction = directions_[static_cast<size_t>(k) % 2];
    commands.dispatch(solver().direction,
                      {.preconditioned = preconditioned_,
                       .previous = previous,
                       .edges = edges_,
                       .nodes = nodes_,
                       .scalars = scalars_,
                       .directions = direction,
                       .products = products_,
                       .partials = partials_,
                       .stroke_mask = strokes_.mask(level),
                       .stroke_means = strokes_.means()},
                      push, strips);
    reduce(Scalars::kAlpha);
    commands.dispatch(solver().update,
                      {.solution = gpu::aliased(at.solution),
                       .preconditioned = gpu::aliased(preconditioned_),
                       .directions = direction,
                       .products = products_,
                       .nodes = nodes_,
                       .scalars = scalars_,
                       .solution_out = at.solution,
                       .preconditioned_out = preconditioned_,
                       .partials = partials_},
                      push, strips);
    reduce(Scalars::kBeta);
  };
  for (int k = 0; k < params_.pcg_iterations; ++k) {
    if (params_.residual_tolerance > 0)
      commands.when(scalars_, Scalars::CG_CONTINUES * sizeof(float), [&] { iterate(k); });
    else
      iterate(k);
  }
}

void ThesisDecomposition::schwarz(gpu::Commands& commands, size_t level, int step) {
  Level& at = levels_[level];
  if (!at.spare) at.spare = gpu::Buffer::create(device_, gpu::Element::vec4, at.extent.pixels());
  Push push = push_for(level);
  push.count = params_.pcg_iterations;
  push.shift = {halton(step, 2), halton(step, 3)};
  const auto blocks = [](int32_t size, int32_t shift) {
    return static_cast<uint32_t>((size + shift - 1) / kBlock + 1);
  };
  commands.dispatch(
      solver().schwarz,
      {.solution = at.solution,
       .preconditioned = preconditioned_,
       .edges = edges_,
       .nodes = nodes_,
       .result = at.spare,
       .stroke_mask = strokes_.mask(level),
       .stroke_means = strokes_.means()},
      push,
      {blocks(push.size[0], push.shift[0]) * kBlockGroup, blocks(push.size[1], push.shift[1])});
  std::swap(at.solution, at.spare);
}

void ThesisDecomposition::solve(gpu::Commands& commands, size_t level) {
  const Level& at = levels_[level];
  const Push push = push_for(level);
  const gpu::Items pixels = pixels_of(at.extent);
  commands.dispatch(solver().setup, {.image = at.image, .links = links_}, push, pixels);
  const bool sources = push.w_clustering > 0 || push.w_known > 0 || push.samples > 0;
  if (sources) {
    Push past = push;
    if (push.frames == 1) past.samples = 0;  // nothing but clusters and what is known
    dispatch_with_frames(commands, at.sample_past, at.frames,
                         {.image = at.image,
                          .clusters = clusters_,
                          .sources = constant_sources_,
                          .known_targets = known_.targets(level)},
                         past, pixels);
  } else {
    commands.fill(sources_);
  }
  for (int step = 0; step <= params_.irls_iterations; ++step) {
    const bool last = step == params_.irls_iterations;
    const bool evaluated = params_.trace || (last && level == 0 && params_.energy);
    if (last && !evaluated) break;
    if (sources || evaluated) pack(commands, level, 0);
    strokes_.record_means(commands, level, at.solution);
    if (evaluated) evaluate(commands, level, step - 1);
    if (last) break;
    if (sources)
      dispatch_with_frames(
          commands, at.sample, at.frames,
          {.image = at.image, .constant_sources = constant_sources_, .sources = sources_}, push,
          pixels);
    commands.dispatch(solver().reweight,
                      {.solution = at.solution,
                       .links = links_,
                       .sources = sources_,
                       .image = at.image,
                       .edges = edges_,
                       .nodes = nodes_,
                       .preconditioned = preconditioned_,
                       .partials = partials_,
                       .stroke_mask = strokes_.mask(level),
                       .stroke_means = strokes_.means()},
                      push, strips_of(at.extent));
    if (params_.solver == Params::Solver::pcg)
      conjugate_gradients(commands, level, step == 0);
    else
      schwarz(commands, level, step);
  }
}

/// The frame's plan and statistics, in `current_`.
void ThesisDecomposition::begin(gpu::Commands& commands) {
  if (!cleared_) {
    // Sums leave some slots untouched, and the first direction is multiplied by zero.
    for (const auto& buffer : {partials_, energy_partials_, sample_partials_}) {
      if (buffer) commands.fill(buffer);
    }
    cleared_ = true;
  }
  commands.fill(scalars_);  // counts the frame's iterations
  current_ = &readback_[recorded_++].stats;
  *current_ = {plan_thesis(params_, levels(), stored_keyframes_, since_reset_)};
  current_->levels = levels();
  current_->irls_iterations = params_.irls_iterations;
  current_->pcg_iterations = params_.pcg_iterations;
}

void ThesisDecomposition::downsample(gpu::Commands& commands, size_t level,
                                     const gpu::BufferPtr& fine, const gpu::BufferPtr& coarse) {
  Push push = push_for(level);
  push.other_size = levels_[level - 1].extent;
  commands.dispatch(downsample_, {.fine = fine, .coarse = coarse}, push,
                    pixels_of(levels_[level].extent));
}

void ThesisDecomposition::build_pyramid(gpu::Commands& commands, const Plane& frame,
                                        const KnownReflectance* known) {
  commands.dispatch(sanitize_, {.frame = frame.buffer, .image = levels_[0].image}, push_for(0),
                    pixels_of(extent_));
  for (size_t n = 1; n < levels_.size(); ++n)
    downsample(commands, n, levels_[n - 1].image, levels_[n].image);
  strokes_.record_levels(commands);
  commands.stage("pyramid");
  // The scale of the frame before is that of what is known.
  known_.record(commands, recorded_ > 1 ? known : nullptr,
                {.image = levels_[0].image,
                 .scale = scale_.value(),
                 .log_floor = params_.log_floor,
                 .chroma_floor = params_.chroma_floor});
  if (known_.weight() == 0) return;
  for (size_t n = 1; n < levels_.size(); ++n)
    downsample(commands, n, known_.targets(n - 1), known_.targets(n));
  commands.stage("recall");
}

/// The start of the coarsest level, or of a finer one.
void ThesisDecomposition::start(gpu::Commands& commands, size_t level) {
  const Level& at = levels_[level];
  Push push = push_for(level);
  if (level + 1 == levels_.size()) {
    commands.dispatch(
        start_,
        {.image = at.image, .known_targets = known_.targets(level), .solution = at.solution}, push,
        pixels_of(at.extent));
    return;
  }
  const Level& coarse = levels_[level + 1];
  push.other_size = coarse.extent;
  commands.dispatch(prolong_, {.coarse = coarse.solution, .solution = at.solution}, push,
                    pixels_of(at.extent));
}

void ThesisDecomposition::find_clusters(gpu::Commands& commands) {
  palette_.record_update(commands, {levels_[1].extent, levels_[1].solution});
  palette_.record_assign(commands, {extent_, levels_[0].solution}, {extent_, clusters_});
  commands.stage("clusters");
}

void ThesisDecomposition::store_keyframe(gpu::Commands& commands) {
  for (size_t n = 0; n < levels_.size(); ++n)
    pack(commands, n, 1 + stored_keyframes_ % params_.keyframes);
  ++stored_keyframes_;
}

void ThesisDecomposition::write_layers(gpu::Commands& commands, Layers& layers) {
  const gpu::BufferPtr& solution = levels_[0].solution;
  commands.dispatch(scale_cells_,
                    {.solution = solution,
                     .palette_scale = palette_.scale(),
                     .cells = scale_.cells(),
                     .target = target_scale_},
                    {.size = extent_}, pixels_of(cells_of(extent_)));
  using History = ScaleNormalization::History;
  scale_.record(commands, {.target = target_scale_,
                           .history = since_reset_ > 0 ? History::taken : History::none});
  const PlanePtr plane = pool_.acquire();
  commands.dispatch(layers_,
                    {.solution = solution, .scale = scale_.value(), .layers = plane->buffer},
                    push_for(0), pixels_of(extent_));
  layers.extent = extent_;
  layers[Role::intrinsic] = layers[Role::model] = plane;
  solution_ = {extent_, solution};
  commands.stage("layers");
}

uint64_t ThesisDecomposition::record(gpu::Commands& commands, const Plane& frame, Layers& layers,
                                     const KnownReflectance* known) {
  if (frame.extent != extent_)
    throw Error(ErrorKind::internal, "the decomposition was made for another frame size");
  const uint64_t number = recorded_;
  begin(commands);
  build_pyramid(commands, frame, known);
  for (size_t n = levels_.size(); n-- > 0;) {
    start(commands, n);
    if (n == 0 && current_->clustered) find_clusters(commands);
    solve(commands, n);
    commands.stage(n == 0 ? "finest-level" : "coarser-level");
  }
  if (!current_->clustered) palette_.record_update(commands, {extent_, levels_[0].solution});
  if (current_->store_keyframe) store_keyframe(commands);
  write_layers(commands, layers);
  read_back(commands, readback_[number].buffer);
  ++since_reset_;
  return number;
}

}  // namespace inverse
