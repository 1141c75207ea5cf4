#pragma once
#include <cstdint>

namespace inverse {

/// The push constants of all kernels of the thesis' method; what each means is in energy.glsl.
struct ThesisPush {
  int32_t size[2], other_size[2], shift[2];
  int32_t count, mode, samples, frames, ring_start, ring_capacity, slot;
  uint32_t stream, seed;
  float w_data, w_intensity, w_reflectance, w_shading, w_chromaticity, w_non_local, w_clustering;
  float w_cs, alpha_cs, alpha_clustering, sample_threshold, log_floor, chroma_floor, p, epsilon2;
  float irls_factor, settled;
};

}  // namespace inverse
