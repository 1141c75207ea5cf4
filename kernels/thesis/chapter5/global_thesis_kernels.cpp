// The kernels of GlobalThesis for a number of planes of indirect layers.
#include "global_thesis_push.hpp"
#include "kernels/gpu/shaders.hpp"

INVERSE_SHADER(thesis_chapter5_setup_sanitize);
INVERSE_SHADER(thesis_chapter5_setup_setup);
INVERSE_SHADER(thesis_chapter5_setup_aim);
INVERSE_SHADER(thesis_chapter5_setup_start);
INVERSE_SHADER(thesis_chapter5_samples_pack);
INVERSE_SHADER(thesis_chapter5_samples_sample);
INVERSE_SHADER(thesis_chapter5_samples_sample_past);
INVERSE_SHADER(thesis_chapter5_solve_reweight);
INVERSE_SHADER(thesis_chapter5_solve_mix);
INVERSE_SHADER(thesis_chapter5_solve_product);
INVERSE_SHADER(thesis_chapter5_solve_update);
INVERSE_SHADER(thesis_chapter5_solve_settle);
INVERSE_SHADER(thesis_chapter5_solve_scalars);
INVERSE_SHADER(thesis_chapter5_energy_energy);
INVERSE_SHADER(thesis_chapter5_energy_energy_pulls);
INVERSE_SHADER(thesis_chapter5_energy_total);
INVERSE_SHADER(thesis_chapter5_output_layers);
INVERSE_SHADER(thesis_chapter5_output_indirect);
INVERSE_SHADER(thesis_chapter5_colors_residual);
INVERSE_SHADER(thesis_chapter5_colors_outer);
INVERSE_SHADER(thesis_chapter5_colors_outer_total);
INVERSE_SHADER(thesis_chapter5_regions_score);
INVERSE_SHADER(thesis_chapter5_setup_cells);
INVERSE_SHADER(thesis_chapter5_setup_change);
INVERSE_SHADER(thesis_chapter5_solve_search);
INVERSE_SHADER(thesis_chapter5_solve_shorten);

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
  k.sanitize = plain(shaders::thesis_chapter5_setup_sanitize);
  k.setup = plain(shaders::thesis_chapter5_setup_setup);
  k.aim = plain(shaders::thesis_chapter5_setup_aim);
  k.start = layered(shaders::thesis_chapter5_setup_start);
  k.pack = plain(shaders::thesis_chapter5_samples_pack);
  k.sample = sampling(shaders::thesis_chapter5_samples_sample);
  k.sample_past = sampling(shaders::thesis_chapter5_samples_sample_past);
  k.reweight = device_->kernel(shaders::thesis_chapter5_solve_reweight, {kAnySlots, planes, unit});
  k.mix = layered(shaders::thesis_chapter5_solve_mix);
  k.product =
      device_->kernel(shaders::thesis_chapter5_solve_product, {kAnySlots, kAnyGroups, unit});
  k.update = layered(shaders::thesis_chapter5_solve_update);
  k.settle = plain(shaders::thesis_chapter5_solve_settle);
  k.scalars = plain(shaders::thesis_chapter5_solve_scalars, kOneGroup);
  k.energy = layered(shaders::thesis_chapter5_energy_energy);
  k.energy_pulls = sampling(shaders::thesis_chapter5_energy_energy_pulls);
  k.total = plain(shaders::thesis_chapter5_energy_total, kOneGroup);
  k.layers = layered(shaders::thesis_chapter5_output_layers);
  k.indirect = plain(shaders::thesis_chapter5_output_indirect);
  k.residual = layered(shaders::thesis_chapter5_colors_residual);
  k.outer = plain(shaders::thesis_chapter5_colors_outer);
  k.outer_total = plain(shaders::thesis_chapter5_colors_outer_total, kOneGroup);
  k.score = layered(shaders::thesis_chapter5_regions_score);
  k.cells = plain(shaders::thesis_chapter5_setup_cells);
  k.change = plain(shaders::thesis_chapter5_setup_change, kOneGroup);
  k.search = plain(shaders::thesis_chapter5_solve_search, kOneGroup);
  k.shorten = plain(shaders::thesis_chapter5_solve_shorten);
  held = std::make_shared<Kernels>(std::move(k));
  return *held;
}

}  // namespace inverse
