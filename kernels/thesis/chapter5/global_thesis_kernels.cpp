// SPDX-License-Identifier: LGPL-2.1-or-later
// The kernels of GlobalThesis for a number of planes of indirect layers.
#include "global_thesis_programs.hpp"
#include "kernels/gpu/reduce.hpp"

namespace inverse {
using namespace global_thesis;

const GlobalThesis::Kernels& GlobalThesis::kernels(int groups) {
  std::shared_ptr<Kernels>& held = kernels_.at(static_cast<size_t>(groups));
  if (held) return *held;
  // Constants are set only in kernels that depend on them, so that as few as possible are built:
  // slots of a buffer of frames, planes of indirect layers, whether p is 1 (energy.glsl,
  // sample_frames.glsl).
  const bool unit = params_.p == 1;
  held = std::make_shared<Kernels>(Kernels{
      .sanitize = {device_},
      .setup = {device_},
      .targets = {device_},
      .start = {device_, {.groups = groups}},
      .pack = {device_},
      .sample = {device_, {.slots = slots_}},
      .sample_past = {device_, {.slots = slots_}},
      .reweight = {device_, {.groups = groups, .unit_exponent = unit}},
      .mix = {device_, {.groups = groups}},
      .product = {device_, {.unit_exponent = unit}},
      .update = {device_, {.groups = groups}},
      .limit_step = {device_},
      .scalars = {device_, {}, gpu::kOneGroup},
      .energy = {device_, {.groups = groups}},
      .energy_samples = {device_, {.slots = slots_}},
      .total = {device_, {}, gpu::kOneGroup},
      .layers = {device_, {.groups = groups}},
      .indirect = {device_},
      .residual = {device_, {.groups = groups}},
      .normal_equations = {device_},
      .normal_equations_total = {device_, {}, gpu::kOneGroup},
      .score = {device_, {.groups = groups}},
      .cells = {device_},
      .change = {device_, {}, gpu::kOneGroup},
      .search = {device_, {}, gpu::kOneGroup},
      .scale_step = {device_},
  });
  return *held;
}

void GlobalThesis::make_kernels() {
  for (int layers = 0; layers <= max_layers_; layers += 4) kernels(layers / 4);
}

}  // namespace inverse
