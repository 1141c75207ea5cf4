// SPDX-License-Identifier: LGPL-2.1-or-later
#include "global_methods.hpp"

namespace inverse::extremes {

uint32_t GlobalLayers::colors() const {
  uint32_t count = 0;
  for (size_t i = 3; i < bases.size(); i += 4) count += bases[i] > 0;
  return count;
}

GlobalMethod::GlobalMethod(const Lab& lab, Solver solver, Extent extent)
    : lab_(lab), extent_(extent) {
  if (solver == Solver::global)
    global_ = std::make_unique<GlobalIntrinsic>(lab.device(), extent);
  else
    thesis_ = std::make_unique<GlobalThesis>(lab.device(), extent);
}

void GlobalMethod::set(const Case& one) {
  if (global_)
    set(global_params_of(one));
  else
    set(global_thesis_params_of(one));
}

void GlobalMethod::reset() {
  if (global_)
    global_->reset();
  else
    thesis_->reset();
  first_ = true;
}

GlobalLayers GlobalMethod::decompose(const Pixels& frame, std::span<const uint8_t> changed) {
  const PlanePtr input = lab_.plane(extent_, frame);
  Layers layers;
  uint64_t number = 0;
  if (thesis_ && first_ && !thesis_->colors().given()) {
    lab_.run([&](gpu::Commands& commands) { thesis_->record_colors(commands, *input); });
    thesis_->collect_colors();
  }
  first_ = false;
  lab_.run([&](gpu::Commands& commands) {
    if (global_)
      layers = global_->record(commands, input, params_, {false, true, changed});
    else
      number = thesis_->record(commands, *input, layers);
  });
  if (thesis_) {
    thesis_->collect(number);
    stats_ = thesis_->stats(number);
  } else {
    const uint64_t last = global_->recorded() - 1;
    found_ = global_->findings(last);
    last_stats_ = global_->stats(last);
  }
  GlobalLayers got;
  got.intrinsic = lab_.download(layers[Role::intrinsic]->buffer);
  got.light = lab_.download(layers[Role::light]->buffer);
  if (layers[Role::bases]) got.bases = lab_.download(layers[Role::bases]->buffer);
  for (uint32_t n = 0; n < kIndirectPlanes; ++n)
    if (const PlanePtr& plane = layers[indirect_role(n)])
      got.shares.push_back(lab_.download(plane->buffer));
  return got;
}

}  // namespace inverse::extremes
