// SPDX-License-Identifier: LGPL-2.1-or-later
// The solver of GlobalThesis: Gauss–Newton steps by conjugate gradients, and what follows from a
// solution.
#include <algorithm>

#include "global_thesis_programs.hpp"
#include "kernels/gpu/reduce.hpp"

namespace inverse {
using namespace global_thesis;
namespace {

constexpr auto kStrip = static_cast<uint32_t>(shaders::thesis_chapter5_solve_product::kStrip);
constexpr uint32_t kOuterLanes = 2048;  // invocations that the pixels of an outer product share

}  // namespace

/// As the shaders bind them; those that there are not are never read.
std::array<gpu::BufferPtr, 6> GlobalThesis::frame_buffers() const {
  std::array<gpu::BufferPtr, 6> buffers;
  buffers.fill(frames_.front());
  std::copy(frames_.begin(), frames_.end(), buffers.begin());
  return buffers;
}

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
  const auto frames = frame_buffers();
  commands.dispatch(at_->energy_pulls,
                    {.frames0 = frames[0],
                     .frames1 = frames[1],
                     .frames2 = frames[2],
                     .frames3 = frames[3],
                     .frames4 = frames[4],
                     .frames5 = frames[5],
                     .features = features_,
                     .state = solution(),
                     .partials = energy_partials_[2]},
                    push, pixels);
  std::vector<Energy>& trace = current_->stats.energy;
  push.count = static_cast<int32_t>(gpu::partial_count(*at_->energy.kernel(), pixels));
  push.slot = static_cast<int32_t>(trace.size());
  commands.dispatch(at_->total,
                    {.first = energy_partials_[0],
                     .pulls = energy_partials_[2],
                     .second = energy_partials_[1],
                     .trace = trace_},
                    push, {kOneGroup});
  trace.push_back({step, 0, 0, 0, 0, 0, 0, 0, 0});
}

void GlobalThesis::begin_search(gpu::Commands& commands) {
  hold_energies(commands);
  sum_energy(commands, solution());
  Push push = push_for();
  push.count = static_cast<int32_t>(
      gpu::partial_count(*at_->energy.kernel(), {extent_.width, extent_.height}));
  commands.dispatch(at_->search,
                    {.first = energy_partials_[0],
                     .second = energy_partials_[1],
                     .search = search_,
                     .shorten = shorten_},
                    push, {kOneGroup});
}

/// Shortens the step from the present state to the next one where it has to be.
void GlobalThesis::search(gpu::Commands& commands) {
  const gpu::BufferPtr& from = states_[current_state_];
  const gpu::BufferPtr& next = states_[1 - current_state_];
  const gpu::Items field{extent_.width, extent_.height, static_cast<uint32_t>(groups_) + 1};
  Push push = push_for();
  push.count = static_cast<int32_t>(
      gpu::partial_count(*at_->energy.kernel(), {extent_.width, extent_.height}));
  const auto judge = [&](int mode) {
    sum_energy(commands, next);
    push.mode = mode;
    commands.dispatch(at_->search,
                      {.first = energy_partials_[0],
                       .second = energy_partials_[1],
                       .search = search_,
                       .shorten = shorten_},
                      push, {kOneGroup});
  };
  judge(1);
  commands.when(shorten_, 0, [&] {
    commands.dispatch(at_->scale_step, {.state = from, .search = search_, .next = next}, push,
                      field);
    judge(2);
    commands.dispatch(at_->scale_step, {.state = from, .search = search_, .next = next}, push,
                      field);
    judge(3);
    commands.dispatch(at_->scale_step, {.state = from, .search = search_, .next = next}, push,
                      field);
  });
}

void GlobalThesis::step(gpu::Commands& commands) {
  const gpu::Items pixels{extent_.width, extent_.height};
  const gpu::BufferPtr& from = states_[current_state_];
  const gpu::BufferPtr& next = states_[1 - current_state_];
  Push push = push_for();
  const auto frames = frame_buffers();
  commands.dispatch(at_->sample,
                    {.frames0 = frames[0],
                     .frames1 = frames[1],
                     .frames2 = frames[2],
                     .frames3 = frames[3],
                     .frames4 = frames[4],
                     .frames5 = frames[5],
                     .features = features_,
                     .constant_pulls = constant_pulls_,
                     .pulls = pulls_},
                    push, pixels);
  commands.dispatch(at_->reweight,
                    {.table = current_->table,
                     .state = from,
                     .image = image_,
                     .features = features_,
                     .pulls = pulls_,
                     .nodes = nodes_,
                     .diagonals = diagonals_,
                     .preconditioned = preconditioned_,
                     .next = next,
                     .partials = partials_},
                    push, pixels);
  push.count = static_cast<int32_t>(gpu::partial_count(*at_->reweight.kernel(), pixels));
  commands.dispatch(at_->scalars, {.partials = partials_, .scalars = scalars_}, push, {kOneGroup});

  const auto planes = static_cast<uint32_t>(groups_) + 1;
  const gpu::Items strips{extent_.width, (extent_.height - 1) / kStrip + 1, planes};
  const gpu::Items tall{extent_.width, (extent_.height * planes - 1) / kStrip + 1};
  for (int k = 0; k < params_.pcg_iterations; ++k) {
    commands.dispatch(at_->mix,
                      {.table = current_->table,
                       .preconditioned = preconditioned_,
                       .previous = directions_,
                       .nodes = nodes_,
                       .scalars = scalars_,
                       .directions = gpu::aliased(directions_),
                       .forces = forces_},
                      push, pixels);
    commands.dispatch(at_->product,
                      {.table = current_->table,
                       .directions = directions_,
                       .state = from,
                       .forces = forces_,
                       .diagonals = diagonals_,
                       .products = products_,
                       .partials = partials_},
                      push, strips);
    push.mode = 1;
    push.count = static_cast<int32_t>(gpu::partial_count(*at_->product.kernel(), strips));
    commands.dispatch(at_->scalars, {.partials = partials_, .scalars = scalars_}, push,
                      {kOneGroup});
    commands.dispatch(at_->update,
                      {.next = next,
                       .preconditioned = preconditioned_,
                       .directions = directions_,
                       .products = products_,
                       .diagonals = diagonals_,
                       .scalars = scalars_,
                       .next_out = gpu::aliased(next),
                       .preconditioned_out = gpu::aliased(preconditioned_),
                       .partials = partials_},
                      push, tall);
    push.mode = 2;
    push.count = static_cast<int32_t>(gpu::partial_count(*at_->update.kernel(), tall));
    commands.dispatch(at_->scalars, {.partials = partials_, .scalars = scalars_}, push,
                      {kOneGroup});
  }
  commands.dispatch(at_->limit_step, {.state = from, .next = next, .next_out = gpu::aliased(next)},
                    push, {extent_.width, extent_.height, planes});
  if (params_.line_search) search(commands);
  current_state_ = 1 - current_state_;
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
                    push, {kOneGroup * entries});
  commands.copy(system_, current_->buffer, 16 * static_cast<uint64_t>(entries), 0, 16 * kSystemAt);
  colors_.fix();
  current_->refining = true;
  current_->stats.refining = true;
  current_->version = colors_.version();
  current_->colors = colors_.layer_colors();
  current_->initial = colors_.layer_colors(true);
  system_pending_ = true;
  commands.stage("refinement");
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
