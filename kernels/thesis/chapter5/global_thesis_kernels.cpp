// The kernels of GlobalThesis for a number of planes of indirect layers.
#include "../gpu/shaders.hpp"
#include "global_thesis_push.hpp"

INVERSE_SHADER(global_thesis_sanitize);
INVERSE_SHADER(global_thesis_setup);
INVERSE_SHADER(global_thesis_aim);
INVERSE_SHADER(global_thesis_start);
INVERSE_SHADER(global_thesis_pack);
INVERSE_SHADER(global_thesis_sample);
INVERSE_SHADER(global_thesis_sample_past);
INVERSE_SHADER(global_thesis_reweight);
INVERSE_SHADER(global_thesis_mix);
INVERSE_SHADER(global_thesis_product);
INVERSE_SHADER(global_thesis_update);
INVERSE_SHADER(global_thesis_settle);
INVERSE_SHADER(global_thesis_scalars);
INVERSE_SHADER(global_thesis_energy);
INVERSE_SHADER(global_thesis_energy_pulls);
INVERSE_SHADER(global_thesis_total);
INVERSE_SHADER(global_thesis_layers);
INVERSE_SHADER(global_thesis_indirect);
INVERSE_SHADER(global_thesis_residual);
INVERSE_SHADER(global_thesis_outer);
INVERSE_SHADER(global_thesis_outer_total);
INVERSE_SHADER(global_thesis_score);
INVERSE_SHADER(global_thesis_cells);
INVERSE_SHADER(global_thesis_change);
INVERSE_SHADER(global_thesis_search);
INVERSE_SHADER(global_thesis_shorten);

namespace inverse {
using namespace global_thesis;

const GlobalThesis::Kernels& GlobalThesis::kernels(int groups) {
  std::shared_ptr<Kernels>& held = kernels_.at(static_cast<size_t>(groups));
  if (held) return *held;
  // Kernels are told only what they depend on, so that as few as possible are built: frames of a
  // buffer, planes of indirect layers, whether p is 1 (energy.glsl, sample_frames.glsl).
  constexpr uint32_t kAnySlots = 6, kAnyGroups = 4;
  const auto planes = static_cast<uint32_t>(groups);
  const uint32_t unit = params_.p == 1 ? 1 : 0;
  const auto plain = [&](const gpu::KernelSource& source, uint32_t workgroup = 0) {
    return device_->kernel(source, {}, workgroup);
  };
  const auto sampling = [&](const gpu::KernelSource& source) {
    return device_->kernel(source, {static_cast<uint32_t>(slots_)});
  };
  const auto layered = [&](const gpu::KernelSource& source) {
    return device_->kernel(source, {kAnySlots, planes});
  };
  Kernels k;
  k.sanitize = plain(shaders::global_thesis_sanitize);
  k.setup = plain(shaders::global_thesis_setup);
  k.aim = plain(shaders::global_thesis_aim);
  k.start = layered(shaders::global_thesis_start);
  k.pack = plain(shaders::global_thesis_pack);
  k.sample = sampling(shaders::global_thesis_sample);
  k.sample_past = sampling(shaders::global_thesis_sample_past);
  k.reweight = device_->kernel(shaders::global_thesis_reweight, {kAnySlots, planes, unit});
  k.mix = layered(shaders::global_thesis_mix);
  k.product = device_->kernel(shaders::global_thesis_product, {kAnySlots, kAnyGroups, unit});
  k.update = layered(shaders::global_thesis_update);
  k.settle = plain(shaders::global_thesis_settle);
  k.scalars = plain(shaders::global_thesis_scalars, kOneGroup);
  k.energy = layered(shaders::global_thesis_energy);
  k.energy_pulls = sampling(shaders::global_thesis_energy_pulls);
  k.total = plain(shaders::global_thesis_total, kOneGroup);
  k.layers = layered(shaders::global_thesis_layers);
  k.indirect = plain(shaders::global_thesis_indirect);
  k.residual = layered(shaders::global_thesis_residual);
  k.outer = plain(shaders::global_thesis_outer);
  k.outer_total = plain(shaders::global_thesis_outer_total, kOneGroup);
  k.score = layered(shaders::global_thesis_score);
  k.cells = plain(shaders::global_thesis_cells);
  k.change = plain(shaders::global_thesis_change, kOneGroup);
  k.search = plain(shaders::global_thesis_search, kOneGroup);
  k.shorten = plain(shaders::global_thesis_shorten);
  held = std::make_shared<Kernels>(std::move(k));
  return *held;
}

}  // namespace inverse
