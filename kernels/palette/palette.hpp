// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/palette_assign.spv.hpp"
#include "kernels/palette_average.spv.hpp"
#include "kernels/palette_cluster.spv.hpp"
#include "kernels/palette_compact.spv.hpp"
#include "kernels/palette_count.spv.hpp"
#include "kernels/palette_merge.spv.hpp"
#include "kernels/palette_scale.spv.hpp"
#include "kernels/palette_scale_count.spv.hpp"
#include "kernels/palette_seed.spv.hpp"

namespace inverse {

/// The reflectance clusters of a video (thesis, section 3.4.4): a histogram of 30³ bins averaged
/// over time, weighted k-means started from the previous frame's clusters, duplicates merged. All
/// of it on the device. Equal frames, parameters and seed give equal clusters. Indices are stable:
/// a color keeps its index from frame to frame, and merged clusters have the lower index.
class Palette {
 public:
  static constexpr uint32_t kMaxClusters = shaders::palette_merge::kMaxClusters;

  struct Params {
    int clusters = 10;     ///< K, 1…16
    int iterations = 8;    ///< of k-means a frame, 1…64
    float decay = 0.1f;    ///< share of the newest frame in histogram and scale, 0…1
    float fade = 0.1f;     ///< the same for bins that are empty in the newest frame: 0.3 removes an
                           ///< absent color of 20 000 pixels in two seconds, 0.1 in six
    float apart = 0;       ///< min chromaticity distance (mean 1) of a new cluster, after the first
                           ///< frame, from the others, 0…3: keeps a color's index
    float tau_cc = 0.05f;  ///< merge below this chromaticity distance (mean 1), 0…3
    float tau_intensity = 0.15f;    ///< and below this difference of ln mean R, ≥ 0
    float chroma_floor = 3e-3f;     ///< ε_c of the chromaticity, > 0
    float white_quantile = 0.995f;  ///< the scale puts this quantile of R, 0…1,
    float white_level = 0.95f;      ///< at this value, > 0
    uint32_t seed = 1;              ///< of the k-means++ start
  };

  /// A cluster on the host.
  struct Cluster {
    std::array<float, 3> color;  ///< linear reflectance in the scale of `scale()`, after merging
    std::array<float, 3> log_color;  ///< ln R in the scale of the planes given to `record_update`
    int index;                       ///< of the cluster that it was merged into; −1: no pixels
  };

  /// Throws Error(limit, out_of_memory).
  explicit Palette(const std::shared_ptr<gpu::Device>& device);

  /// Values outside their range are clamped.
  void set_params(const Params& params);
  const Params& params() const { return params_; }

  /// Adds a frame: rgb of `log_reflectance` is ln R, up to a constant that is the same for all
  /// frames.
  /// Throws Error(limit) beyond 2³² / 255 pixels, the limit of the histogram's sums.
  void record_update(gpu::Commands& commands, const Plane& log_reflectance);

  /// Writes (ln color, index) of the cluster nearest in ln R to each pixel, index −1 if there is no
  /// cluster. Both planes have one size.
  void record_assign(gpu::Commands& commands, const Plane& log_reflectance,
                     const Plane& clusters) const;

  /// Discards histogram, scale and clusters.
  void reset() { first_ = true; }

  /// One scalar: ln of the factor that brings R into the palette's scale.
  const gpu::BufferPtr& scale() const { return scale_; }
  /// 2 · kMaxClusters vec4, as merge.comp describes them.
  const gpu::BufferPtr& colors() const { return palette_; }
  /// Reads a host copy of `colors()`.
  static std::vector<Cluster> read(const float* colors, int count);

 private:
  using Push = shaders::palette_count::Push;  // that of all
  Push push_for(Extent extent, float fraction_scale) const;

  gpu::Program<shaders::palette_scale_count> scale_count_;
  gpu::Program<shaders::palette_scale> scale_kernel_;
  gpu::Program<shaders::palette_count> count_;
  gpu::Program<shaders::palette_average> average_;
  gpu::Program<shaders::palette_compact> compact_;
  gpu::Program<shaders::palette_seed> seed_;
  gpu::Program<shaders::palette_cluster> cluster_;
  gpu::Program<shaders::palette_merge> merge_;
  gpu::Program<shaders::palette_assign> assign_;
  gpu::BufferPtr scale_counts_, scale_, counts_, list_, list_length_, clusters_, labels_, palette_;
  std::array<gpu::BufferPtr, 2> histogram_;
  Params params_;
  uint32_t frame_ = 0;
  bool first_ = true;
  bool cleared_ = false;
};

}  // namespace inverse
