// SPDX-License-Identifier: LGPL-2.1-or-later
// The solver of GlobalThesis: Gauss–Newton steps by conjugate gradients, and what follows from a
// solution.
#include <algorithm>

#include "global_thesis_programs.hpp"
#include "kernels/gpu/reduce.hpp"
#include "kernels/thesis/shared/sample_frames.hpp"

namespace inverse {
using namespace global_thesis;
namespace {

constexpr auto kStrip = static_cast<uint32_t>(shaders::thesis_chapter5_solve_product::kStrip);
constexpr uint32_t kOuterLanes = 2048;  // invocations that the pixels of an outer product share

}  // namespace

void GlobalThesis::pack(gpu::Commands& commands, int slot) {
  Push push = push_for();
  push.slot = slot % slots_;
  commands.dispatch(at_->pack,
                    {.state = solution(),
                     .features = features_,
                     .frames = frames_[static_cast<size_t>(slot / slots_)]},
                    push, {extent_.width, extent_.height});
}

void GlobalThesis::hold_energies(gpu::Commands& commands) {
  if (energy_partials_[0]) return;
  for (auto& buffer : energy_partials_) {
    buffer = gpu::Buffer::create(
        device_, gpu::Element::vec4,
        gpu::partial_count(*at_->energy.kernel(), {extent_.width, extent_.height}));
    commands.fill(buffer);
  }
}

/// Partial sums of the energy of x without samples.
void GlobalThesis::sum_energy(gpu::Commands& commands, const gpu::BufferPtr& x) {
  commands.dispatch(at_->energy,
                    {.table = current_->table,
                     .state = x,
                     .image = image_,
                     .targets = targets_,
                     .features = features_,
                     .first_partials = energy_partials_[0],
                     .second_partials = energy_partials_[1]},
                    push_for(), {extent_.width, extent_.height});
}

void GlobalThesis::evaluate(gpu::Commands& commands, int step) {
  const gpu::Items pixels{extent_.width, extent_.height};
  hold_energies(commands);
  Push push = push_for();
  sum_energy(commands, solution());
  dispatch_with_frames(
      commands, at_->energy_samples, frames_,
      {.features = features_, .state = solution(), .partials = energy_partials_[2]}, push, pixels);
  std::vector<Energy>& trace = current_->stats.energy;
  push.count = static_cast<int32_t>(gpu::partial_count(*at_->energy.kernel(), pixels));
  push.slot = static_cast<int32_t>(trace.size());
  commands.dispatch(at_->total,
                    {.first = energy_partials_[0],
                     .samples = energy_partials_[2],
                     .second = energy_partials_[1],
                     .trace = trace_},
                    push, {gpu::kOneGroup});
  trace.push_back({step, 0, 0, 0, 0, 0, 0, 0, 0});
}

/// Whether the line search accepts x, with a mode of search.comp.
void GlobalThesis::check_step(gpu::Commands& commands, const gpu::BufferPtr& x, int mode) {
  sum_energy(commands, x);
  Push push = push_for();
  push.mode = mode;
  push.count = static_cast<int32_t>(
      gpu::partial_count(*at_->energy.kernel(), {extent_.width, extent_.height}));
  commands.dispatch(at_->search,
                    {.first = energy_partials_[0],
                     .second = energy_partials_[1],
                     .search = search_,
                     .rescale = rescale_},
                    push, {gpu::kOneGroup});
}

/// Shortens the step from the present state to the next one if it raises the energy.
void GlobalThesis::search(gpu::Commands& commands) {
  const gpu::BufferPtr& next = states_[1 - current_state_];
  const auto scale = [&] {
    commands.dispatch(
        at_->scale_step, {.state = states_[current_state_], .search = search_, .next = next},
        push_for(), {extent_.width, extent_.height, static_cast<uint32_t>(groups_) + 1});
  };
  check_step(commands, next, Search::kStep);
  commands.when(rescale_, 0, [&] {
    scale();
    check_step(commands, next, Search::kShortened);
    scale();
    check_step(commands, next, Search::kLast);
    scale();
  });
}

/// The scalars of the conjugate gradients, from the partial sums of a dispatch.
template <typename Shader>
void GlobalThesis::reduce(gpu::Commands& commands, int mode, const gpu::Program<Shader>& program,
                          gpu::Items items) {
  commands.dispatch(at_->scalars, {.partials = partials_, .scalars = scalars_},
                    {.count = static_cast<int32_t>(gpu::partial_count(*program.kernel(), items)),
                     .mode = mode,
                     .first = 1,
                     .tolerance = 0},
                    {gpu::kOneGroup});
}

void GlobalThesis::conjugate_gradients(gpu::Commands& commands) {
  using Scalars = shaders::thesis_shared_scalars;
  const gpu::BufferPtr& next = states_[1 - current_state_];
  const auto planes = static_cast<uint32_t>(groups_) + 1;
  const gpu::Items pixels{extent_.width, extent_.height};
  const gpu::Items strips{extent_.width, (extent_.height - 1) / kStrip + 1, planes};
  const gpu::Items tall{extent_.width, (extent_.height * planes - 1) / kStrip + 1};
  const Push push = push_for();
  reduce(commands, Scalars::kSystem, at_->reweight, pixels);
  for (int k = 0; k < params_.pcg_iterations; ++k) {
    commands.dispatch(at_->mix,
                      {.table = current_->table,
                       .preconditioned = preconditioned_,
                       .previous = directions_,
                       .nodes = nodes_,
                       .scalars = scalars_,
                       .directions = gpu::aliased(directions_),
                       .pixel_products = pixel_products_},
                      push, pixels);
    commands.dispatch(at_->product,
                      {.table = current_->table,
                       .directions = directions_,
                       .state = states_[current_state_],
                       .pixel_products = pixel_products_,
                       .diagonals = diagonals_,
                       .products = products_,
                       .partials = partials_},
                      push, strips);
    reduce(commands, Scalars::kAlpha, at_->product, strips);
    commands.dispatch(at_->update,
                      {.solution = next,
                       .preconditioned = preconditioned_,
                       .directions = directions_,
                       .products = products_,
                       .diagonals = diagonals_,
                       .scalars = scalars_,
                       .solution_out = gpu::aliased(next),
                       .preconditioned_out = gpu::aliased(preconditioned_),
                       .partials = partials_},
                      push, tall);
    reduce(commands, Scalars::kBeta, at_->update, tall);
  }
}

void GlobalThesis::step(gpu::Commands& commands) {
  const gpu::Items pixels{extent_.width, extent_.height};
  const gpu::BufferPtr& from = states_[current_state_];
  const gpu::BufferPtr& next = states_[1 - current_state_];
  const Push push = push_for();
  dispatch_with_frames(
      commands, at_->sample, frames_,
      {.features = features_, .constant_sources = constant_sources_, .sources = sources_}, push,
      pixels);
  commands.dispatch(at_->reweight,
                    {.table = current_->table,
                     .state = from,
                     .image = image_,
                     .features = features_,
                     .sources = sources_,
                     .nodes = nodes_,
                     .diagonals = diagonals_,
                     .preconditioned = preconditioned_,
                     .next = next,
                     .partials = partials_},
                    push, pixels);
  conjugate_gradients(commands);
  commands.dispatch(at_->limit_step, {.state = from, .next = next, .next_out = gpu::aliased(next)},
                    push, {extent_.width, extent_.height, static_cast<uint32_t>(groups_) + 1});
  if (current_->plan.search) search(commands);
  current_state_ = 1 - current_state_;
}

void GlobalThesis::solve(gpu::Commands& commands) {
  if (current_->plan.search) {
    hold_energies(commands);
    check_step(commands, solution(), Search::kStart);
  }
  for (int n = 0; n <= params_.steps; ++n) {
    const bool last = n == params_.steps;
    pack(commands, 0);
    if (params_.trace || (last && params_.energy)) evaluate(commands, n - 1);
    if (!last) step(commands);
  }
  if (current_->plan.search)
    commands.copy(search_, current_->buffer, search_->bytes(), 0, 16 * kSearchAt);
  has_state_ = true;
  state_order_ = colors_.order();
}

/// The sums of the system for the base colors, into the frame's readback.
void GlobalThesis::record_refinement(gpu::Commands& commands) {
  const gpu::Items pixels{extent_.width, extent_.height};
  const auto layers = static_cast<uint32_t>(colors_.layers());
  const gpu::Items items{kOuterLanes, layers, layers + 1};
  const uint64_t partials = gpu::partial_count(*at_->normal_equations.kernel(), items);
  if (!residuals_) {
    for (auto* buffer : {&residuals_, &reflectances_})
      *buffer = gpu::Buffer::create(device_, gpu::Element::vec4, extent_.pixels());
  }
  if (!outer_partials_ || outer_partials_->count() < partials) {
    outer_partials_ = gpu::Buffer::create(device_, gpu::Element::vec4, partials);
    commands.fill(outer_partials_);
  }
  const uint32_t entries = layers * (layers + 1);
  if (!system_ || system_->count() < entries)
    system_ = gpu::Buffer::create(device_, gpu::Element::vec4, entries);
  Push push = push_for();
  commands.dispatch(at_->residual,
                    {.table = current_->table,
                     .state = solution(),
                     .image = image_,
                     .residuals = residuals_,
                     .reflectances = reflectances_},
                    push, pixels);
  const uint32_t workgroup = at_->normal_equations.kernel()->workgroup();
  push.count =
      static_cast<int32_t>((kOuterLanes - 1) / workgroup + 1) * static_cast<int32_t>(workgroup);
  commands.dispatch(at_->normal_equations,
                    {.state = solution(),
                     .residuals = residuals_,
                     .reflectances = reflectances_,
                     .partials = outer_partials_},
                    push, items);
  push.count = static_cast<int32_t>(partials / entries);
  commands.dispatch(at_->normal_equations_total, {.partials = outer_partials_, .entries = system_},
                    push, {gpu::kOneGroup * entries, 1});
  commands.copy(system_, current_->buffer, 16 * static_cast<uint64_t>(entries), 0, 16 * kSystemAt);
  colors_.fix();
  current_->version = colors_.version();
  current_->colors = colors_.layer_colors();
  current_->initial = colors_.layer_colors(true);
  system_pending_ = true;
  commands.stage("refinement");
}

/// How sparse the indirect light of a region is, into the frame's readback.
void GlobalThesis::score_region(gpu::Commands& commands, const Hints& hints) {
  const gpu::Items pixels{extent_.width, extent_.height};
  if (!score_) score_ = gpu::Buffer::create(device_, gpu::Element::vec4, 1);
  Push push = push_for();
  push.slot = hints.scored_region;
  commands.dispatch(at_->score,
                    {.state = solution(), .regions = hints.buffer(), .partials = partials_}, push,
                    pixels);
  push.count = static_cast<int32_t>(gpu::partial_count(*at_->score.kernel(), pixels));
  commands.dispatch(at_->normal_equations_total, {.partials = partials_, .entries = score_}, push,
                    {gpu::kOneGroup});
  commands.copy(score_, current_->buffer, 16, 0, 16 * kScoreAt);
}

void GlobalThesis::write_layers(gpu::Commands& commands, Layers& layers) {
  static_assert(BaseColors::kMaxColors == kMaxBases);
  const gpu::Items pixels{extent_.width, extent_.height};
  const PlanePtr intrinsic = pool_.acquire(), light = pool_.acquire();
  layers.extent = extent_;
  layers[Role::intrinsic] = layers[Role::model] = intrinsic;
  layers[Role::light] = layers[Role::model_light] = light;
  Push push = push_for();
  commands.dispatch(at_->layers,
                    {.table = current_->table,
                     .state = solution(),
                     .intrinsic = intrinsic->buffer,
                     .light = light->buffer},
                    push, pixels);
  for (uint32_t n = 0; n < kIndirectPlanes; ++n) {
    PlanePtr& plane = layers[indirect_role(n)];
    plane = nullptr;
    if (static_cast<int>(n) >= groups_) continue;
    plane = pool_.acquire();
    push.slot = static_cast<int32_t>(n) + 1;
    commands.dispatch(
        at_->indirect,
        {.state = solution(), .intrinsic = intrinsic->buffer, .indirect = plane->buffer}, push,
        pixels);
  }
  const PlanePtr bases = bases_pool_.acquire();
  commands.copy(current_->table, bases->buffer, 16 * kMaxBases, 16 * 2 * BaseColors::kMaxColors);
  layers[Role::bases] = layers[Role::model_bases] = bases;
}

}  // namespace inverse
