// SPDX-License-Identifier: LGPL-2.1-or-later
// What both halves of GlobalThesis share: programs, sizes.
#pragma once
#include "global_thesis.hpp"
#include "kernels/thesis_chapter5_colors_normal_equations.spv.hpp"
#include "kernels/thesis_chapter5_colors_normal_equations_total.spv.hpp"
#include "kernels/thesis_chapter5_colors_residual.spv.hpp"
#include "kernels/thesis_chapter5_energy_energy.spv.hpp"
#include "kernels/thesis_chapter5_energy_total.spv.hpp"
#include "kernels/thesis_chapter5_output_indirect.spv.hpp"
#include "kernels/thesis_chapter5_output_layers.spv.hpp"
#include "kernels/thesis_chapter5_regions_score.spv.hpp"
#include "kernels/thesis_chapter5_samples_energy_samples.spv.hpp"
#include "kernels/thesis_chapter5_samples_pack.spv.hpp"
#include "kernels/thesis_chapter5_samples_sample.spv.hpp"
#include "kernels/thesis_chapter5_samples_sample_past.spv.hpp"
#include "kernels/thesis_chapter5_setup_cells.spv.hpp"
#include "kernels/thesis_chapter5_setup_change.spv.hpp"
#include "kernels/thesis_chapter5_setup_sanitize.spv.hpp"
#include "kernels/thesis_chapter5_setup_setup.spv.hpp"
#include "kernels/thesis_chapter5_setup_start.spv.hpp"
#include "kernels/thesis_chapter5_setup_targets.spv.hpp"
#include "kernels/thesis_chapter5_solve_limit_step.spv.hpp"
#include "kernels/thesis_chapter5_solve_mix.spv.hpp"
#include "kernels/thesis_chapter5_solve_product.spv.hpp"
#include "kernels/thesis_chapter5_solve_reweight.spv.hpp"
#include "kernels/thesis_chapter5_solve_scale_step.spv.hpp"
#include "kernels/thesis_chapter5_solve_search.spv.hpp"
#include "kernels/thesis_chapter5_solve_update.spv.hpp"
#include "kernels/thesis_shared_scalars.spv.hpp"

namespace inverse {

/// Built for a number of planes of indirect layers.
struct GlobalThesis::Kernels {
  gpu::Program<shaders::thesis_chapter5_setup_sanitize> sanitize;
  gpu::Program<shaders::thesis_chapter5_setup_setup> setup;
  gpu::Program<shaders::thesis_chapter5_setup_targets> targets;
  gpu::Program<shaders::thesis_chapter5_setup_start> start;
  gpu::Program<shaders::thesis_chapter5_samples_pack> pack;
  gpu::Program<shaders::thesis_chapter5_samples_sample> sample;
  gpu::Program<shaders::thesis_chapter5_samples_sample_past> sample_past;
  gpu::Program<shaders::thesis_chapter5_solve_reweight> reweight;
  gpu::Program<shaders::thesis_chapter5_solve_mix> mix;
  gpu::Program<shaders::thesis_chapter5_solve_product> product;
  gpu::Program<shaders::thesis_chapter5_solve_update> update;
  gpu::Program<shaders::thesis_chapter5_solve_limit_step> limit_step;
  gpu::Program<shaders::thesis_shared_scalars> scalars;
  gpu::Program<shaders::thesis_chapter5_energy_energy> energy;
  gpu::Program<shaders::thesis_chapter5_samples_energy_samples> energy_samples;
  gpu::Program<shaders::thesis_chapter5_energy_total> total;
  gpu::Program<shaders::thesis_chapter5_output_layers> layers;
  gpu::Program<shaders::thesis_chapter5_output_indirect> indirect;
  gpu::Program<shaders::thesis_chapter5_colors_residual> residual;
  gpu::Program<shaders::thesis_chapter5_colors_normal_equations> normal_equations;
  gpu::Program<shaders::thesis_chapter5_colors_normal_equations_total> normal_equations_total;
  gpu::Program<shaders::thesis_chapter5_regions_score> score;
  gpu::Program<shaders::thesis_chapter5_setup_cells> cells;
  gpu::Program<shaders::thesis_chapter5_setup_change> change;
  gpu::Program<shaders::thesis_chapter5_solve_search> search;
  gpu::Program<shaders::thesis_chapter5_solve_scale_step> scale_step;
};

namespace global_thesis {

using Search = shaders::thesis_chapter5_solve_search;
// Layout of a readback buffer, in vec4.
constexpr uint64_t kMaxLayers = Palette::kMaxClusters;
constexpr uint64_t kColors = 2 * Palette::kMaxClusters;
constexpr uint64_t kColorsAt = 0, kSystemAt = kColors,
                   kScoreAt = kSystemAt + kMaxLayers * (kMaxLayers + 1), kChangeAt = kScoreAt + 1,
                   kSearchAt = kScoreAt + 2, kTraceAt = kScoreAt + 3;

}  // namespace global_thesis
}  // namespace inverse
