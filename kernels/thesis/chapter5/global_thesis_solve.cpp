// The solver of GlobalThesis: Gauss–Newton steps by conjugate gradients, and what follows from a
// solution.
#include <algorithm>

#include "global_thesis_push.hpp"
#include "kernels/gpu/reduce.hpp"

namespace inverse {
using namespace global_thesis;
namespace {

constexpr uint32_t kStrip = 8;          // pixels an invocation
constexpr uint32_t kOuterLanes = 2048;  // invocations that the pixels of an outer product share

}  // namespace

std::vector<gpu::BufferPtr> GlobalThesis::frame_buffers() const {
  std::vector<gpu::BufferPtr> buffers = frames_;
  buffers.resize(6, buffers.front());
  return buffers;
}

void GlobalThesis::pack(gpu::Commands& commands, int slot) {
  Push push = push_for();
  push.slot = slot % slots_;
  commands.dispatch(at_->pack, {solution(), features_, frames_[static_cast<size_t>(slot / slots_)]},
                    push, {extent_.width, extent_.height});
}

void GlobalThesis::hold_energies(gpu::Commands& commands) {
  if (energy_partials_[0]) return;
  for (auto& buffer : energy_partials_) {
    buffer = gpu::Buffer::create(device_, gpu::Element::vec4,
                                 gpu::partial_count(*at_->energy, {extent_.width, extent_.height}));
    commands.fill(buffer);
  }
}

/// Partial sums of the energy of x without samples.
void GlobalThesis::sum_energy(gpu::Commands& commands, const gpu::BufferPtr& x) {
  commands.dispatch(
      at_->energy,
      {current_->table, x, image_, targets_, features_, energy_partials_[0], energy_partials_[1]},
      push_for(), {extent_.width, extent_.height});
}

void GlobalThesis::evaluate(gpu::Commands& commands, int step) {
  const gpu::Items pixels{extent_.width, extent_.height};
  hold_energies(commands);
  Push push = push_for();
  sum_energy(commands, solution());
  std::vector<gpu::BufferPtr> buffers = frame_buffers();
  buffers.insert(buffers.end(), {features_, solution(), energy_partials_[2]});
  commands.dispatch(at_->energy_pulls, buffers, std::as_bytes(std::span(&push, 1)), pixels);
  std::vector<Energy>& trace = current_->stats.energy;
  push.count = static_cast<int32_t>(gpu::partial_count(*at_->energy, pixels));
  push.slot = static_cast<int32_t>(trace.size());
  commands.dispatch(at_->total,
                    {energy_partials_[0], energy_partials_[2], energy_partials_[1], trace_}, push,
                    {kOneGroup});
  trace.push_back({step, 0, 0, 0, 0, 0, 0, 0, 0});
}

void GlobalThesis::begin_search(gpu::Commands& commands) {
  hold_energies(commands);
  sum_energy(commands, solution());
  Push push = push_for();
  push.count =
      static_cast<int32_t>(gpu::partial_count(*at_->energy, {extent_.width, extent_.height}));
  commands.dispatch(at_->search, {energy_partials_[0], energy_partials_[1], search_, shorten_},
                    push, {kOneGroup});
}

/// Shortens the step from the present state to the next one where it has to be.
void GlobalThesis::search(gpu::Commands& commands) {
  const gpu::BufferPtr& from = states_[current_state_];
  const gpu::BufferPtr& next = states_[1 - current_state_];
  const gpu::Items field{extent_.width, extent_.height, static_cast<uint32_t>(groups_) + 1};
  Push push = push_for();
  push.count =
      static_cast<int32_t>(gpu::partial_count(*at_->energy, {extent_.width, extent_.height}));
  const auto judge = [&](int mode) {
    sum_energy(commands, next);
    push.mode = mode;
    commands.dispatch(at_->search, {energy_partials_[0], energy_partials_[1], search_, shorten_},
                      push, {kOneGroup});
  };
  judge(1);
  commands.when(shorten_, 0, [&] {
    commands.dispatch(at_->shorten, {from, search_, next}, push, field);
    judge(2);
    commands.dispatch(at_->shorten, {from, search_, next}, push, field);
    judge(3);
    commands.dispatch(at_->shorten, {from, search_, next}, push, field);
  });
}

void GlobalThesis::step(gpu::Commands& commands) {
  const gpu::Items pixels{extent_.width, extent_.height};
  const gpu::BufferPtr& from = states_[current_state_];
  const gpu::BufferPtr& next = states_[1 - current_state_];
  Push push = push_for();
  std::vector<gpu::BufferPtr> buffers = frame_buffers();
  buffers.insert(buffers.end(), {features_, constant_pulls_, pulls_});
  commands.dispatch(at_->sample, buffers, std::as_bytes(std::span(&push, 1)), pixels);
  commands.dispatch(at_->reweight,
                    {current_->table, from, image_, features_, pulls_, nodes_, diagonals_,
                     preconditioned_, next, partials_},
                    push, pixels);
  push.count = static_cast<int32_t>(gpu::partial_count(*at_->reweight, pixels));
  commands.dispatch(at_->scalars, {partials_, scalars_}, push, {kOneGroup});

  const auto planes = static_cast<uint32_t>(groups_) + 1;
  const gpu::Items strips{extent_.width, (extent_.height - 1) / kStrip + 1, planes};
  const gpu::Items tall{extent_.width, (extent_.height * planes - 1) / kStrip + 1};
  for (int k = 0; k < params_.pcg_iterations; ++k) {
    commands.dispatch(
        at_->mix,
        {current_->table, preconditioned_, directions_, nodes_, scalars_, directions_, forces_},
        push, pixels);
    commands.dispatch(
        at_->product,
        {current_->table, directions_, from, forces_, diagonals_, products_, partials_}, push,
        strips);
    push.mode = 1;
    push.count = static_cast<int32_t>(gpu::partial_count(*at_->product, strips));
    commands.dispatch(at_->scalars, {partials_, scalars_}, push, {kOneGroup});
    commands.dispatch(at_->update,
                      {next, preconditioned_, directions_, products_, diagonals_, scalars_, next,
                       preconditioned_, partials_},
                      push, tall);
    push.mode = 2;
    push.count = static_cast<int32_t>(gpu::partial_count(*at_->update, tall));
    commands.dispatch(at_->scalars, {partials_, scalars_}, push, {kOneGroup});
  }
  commands.dispatch(at_->settle, {from, next, next}, push, {extent_.width, extent_.height, planes});
  if (params_.line_search) search(commands);
  current_state_ = 1 - current_state_;
}

/// The sums of the system for the base colors, into the frame's readback.
void GlobalThesis::record_refinement(gpu::Commands& commands) {
  const gpu::Items pixels{extent_.width, extent_.height};
  const auto layers = static_cast<uint32_t>(colors_.layers());
  const gpu::Items items{kOuterLanes, layers, layers + 1};
  const uint64_t partials = gpu::partial_count(*at_->outer, items);
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
  commands.dispatch(at_->residual, {current_->table, solution(), image_, residuals_, reflectances_},
                    push, pixels);
  const uint32_t workgroup = at_->outer->workgroup();
  push.count =
      static_cast<int32_t>((kOuterLanes - 1) / workgroup + 1) * static_cast<int32_t>(workgroup);
  commands.dispatch(at_->outer, {solution(), residuals_, reflectances_, outer_partials_}, push,
                    items);
  push.count = static_cast<int32_t>(partials / entries);
  commands.dispatch(at_->outer_total, {outer_partials_, system_}, push, {kOneGroup * entries});
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
  commands.dispatch(at_->layers, {current_->table, solution(), intrinsic->buffer, light->buffer},
                    push, pixels);
  for (uint32_t n = 0; n < kIndirectPlanes; ++n) {
    PlanePtr& plane = layers[indirect_role(n)];
    plane = nullptr;
    if (static_cast<int>(n) >= groups_) continue;
    plane = pool_.acquire();
    push.slot = static_cast<int32_t>(n) + 1;
    commands.dispatch(at_->indirect, {solution(), intrinsic->buffer, plane->buffer}, push, pixels);
  }
  const PlanePtr bases = bases_pool_.acquire();
  commands.copy(current_->table, bases->buffer, 16 * kMaxBases, 16 * 2 * BaseColors::kMaxColors);
  layers[Role::bases] = layers[Role::model_bases] = bases;
}

}  // namespace inverse
