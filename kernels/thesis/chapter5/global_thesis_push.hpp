// What both halves of GlobalThesis share: push constants, kernels, sizes.
#pragma once
#include "global_thesis.hpp"

namespace inverse {

/// The push constants of all kernels of the method; what each means is in energy.glsl.
struct GlobalThesisPush {
  int32_t size[2];
  int32_t count, mode, samples, frames, ring_start, ring_capacity, slot;
  uint32_t stream, seed;
  int32_t centers, layers;
  float lambda_data, lambda_clustering, lambda_r_sparsity, lambda_r_consistency, lambda_monochrome;
  float lambda_i_sparsity, lambda_smoothness, lambda_non_negativity;
  float p, irls_r, irls_light;
  float alpha_sr, w_intensity;
  float sample_threshold;
  float epsilon, epsilon_r, log_floor, chroma_floor, indirect_start;
};

/// Built for a number of planes of indirect layers.
struct GlobalThesis::Kernels {
  gpu::KernelPtr sanitize, setup, aim, start, pack, sample, sample_past, reweight, mix, product,
      update, settle, scalars, energy, energy_pulls, total, layers, indirect, residual, outer,
      outer_total, score, cells, change, search, shorten;
};

namespace global_thesis {

constexpr uint32_t kOneGroup = 128;   // invocations of the kernels that run as one workgroup
constexpr uint32_t kCells = 32 * 32;  // of a frame, as in cells.comp
// Layout of a readback buffer, in vec4.
constexpr uint64_t kMaxLayers = Palette::kMaxClusters;
constexpr uint64_t kColors = 2 * Palette::kMaxClusters;
constexpr uint64_t kColorsAt = 0, kSystemAt = kColors,
                   kScoreAt = kSystemAt + kMaxLayers * (kMaxLayers + 1), kChangeAt = kScoreAt + 1,
                   kSearchAt = kScoreAt + 2, kTraceAt = kScoreAt + 3;

}  // namespace global_thesis
}  // namespace inverse
