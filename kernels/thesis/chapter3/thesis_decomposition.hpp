// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/palette/palette.hpp"
#include "kernels/solve/scale_normalization.hpp"
#include "kernels/thesis/chapter4/thesis_known.hpp"
#include "kernels/thesis/chapter4/thesis_strokes.hpp"
#include "kernels/thesis_chapter3_direction.spv.hpp"
#include "kernels/thesis_chapter3_downsample.spv.hpp"
#include "kernels/thesis_chapter3_energy.spv.hpp"
#include "kernels/thesis_chapter3_layers.spv.hpp"
#include "kernels/thesis_chapter3_pack.spv.hpp"
#include "kernels/thesis_chapter3_prolong.spv.hpp"
#include "kernels/thesis_chapter3_reweight.spv.hpp"
#include "kernels/thesis_chapter3_samples_energy_samples.spv.hpp"
#include "kernels/thesis_chapter3_samples_sample.spv.hpp"
#include "kernels/thesis_chapter3_samples_sample_past.spv.hpp"
#include "kernels/thesis_chapter3_sanitize.spv.hpp"
#include "kernels/thesis_chapter3_scale_cells.spv.hpp"
#include "kernels/thesis_chapter3_schwarz.spv.hpp"
#include "kernels/thesis_chapter3_setup.spv.hpp"
#include "kernels/thesis_chapter3_start.spv.hpp"
#include "kernels/thesis_chapter3_total.spv.hpp"
#include "kernels/thesis_chapter3_update.spv.hpp"
#include "kernels/thesis_shared_scalars.spv.hpp"
#include "thesis_params.hpp"
#include "thesis_plan.hpp"

namespace inverse {

/// The intrinsic video decomposition of the thesis, chapters 3 and 4, for frames of one size. The
/// energies and the systems are in energy.glsl. Keeps keyframes and the palette from frame to
/// frame.
class ThesisDecomposition {
 public:
  using Params = ThesisParams;

  /// Energy by group of terms, summed over the pixels of a level.
  struct Energy {
    int level;  ///< 0 is the finest
    int step;   ///< IRLS step after which it was taken; −1 is the start
    float data_and_chromaticity, sparsity, smoothness;
    float targets;  ///< of samples, clusters, strokes, and what is known
    double total() const {
      return static_cast<double>(data_and_chromaticity) + sparsity + smoothness + targets;
    }
  };

  struct Stats : ThesisPlan {
    int levels = 0;
    int irls_iterations = 0;     ///< a level
    int pcg_iterations = 0;      ///< a reweighting
    float scale = 0;             ///< ln of the factor from the solver's R to the layer's
    int iterations = 0;          ///< of conjugate gradients, all systems; 0 with solver = schwarz
    float residual = 0;          ///< rᵀM⁻¹r of the last system; 0 with solver = schwarz
    std::vector<Energy> energy;  ///< as Params::energy and Params::trace ask for
    std::vector<Palette::Cluster> clusters;
    int cluster_count = 0;  ///< of them that have pixels and are not merged into another
    /// Of each stroke, rms ln shading or ln reflectance from its mean.
    std::vector<float> strokes;
  };

  /// Throws Error(limit, out_of_memory).
  ThesisDecomposition(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Takes effect with the next frame. A change of levels or keyframes forgets the past.
  void set_params(const Params& params);
  const Params& params() const { return params_; }
  /// The user's strokes from the next frame on; without kinds: none.
  void set_strokes(ThesisStrokes strokes);
  int levels() const { return static_cast<int>(levels_.size()); }

  /// Decomposes `frame` (linear RGB, full scale 1, any values; w is ignored), of which `known` is
  /// known (null: nothing; of the first frame nothing is), into
  /// layers[Role::intrinsic] = layers[Role::model] = (R.rgb, S). The first frame's R is scaled so
  /// that its 99.5 % quantile is near 0.95; later frames keep the scale of what stays in view.
  /// Returns the frame's number for `stats`.
  uint64_t record(gpu::Commands& commands, const Plane& frame, Layers& layers,
                  const KnownReflectance* known = nullptr);
  /// Frames recorded since construction.
  uint64_t recorded() const { return recorded_; }

  /// Forgets keyframes and palette: at a flush, a discontinuity or a scene cut.
  void reset();

  /// Statistics of one of the last three frames. Wait for its Commands first. Empty before the
  /// first frame; throws Error(internal) for older ones.
  Stats stats(uint64_t frame) const;

  /// (r, s) of the finest level in the solver's own scale: valid until the next record.
  const Plane& solution() const { return solution_; }
  /// (r_cluster, index) of the last frame's finest level, if its stats say clustered.
  Plane clusters() const { return {extent_, clusters_}; }
  /// (r, packed chromaticity) of a level, which the current frame's samples were drawn from.
  Plane sample_frame(int level) const;
  const Palette& palette() const { return palette_; }

 private:
  struct Level {
    Extent extent;
    gpu::BufferPtr image, solution, spare;
    std::vector<gpu::BufferPtr> frames;  ///< sample frames, `slots` to a buffer
    int slots = 0;
    gpu::Program<shaders::thesis_chapter3_samples_sample> sample;
    gpu::Program<shaders::thesis_chapter3_samples_sample_past> sample_past;
    gpu::Program<shaders::thesis_chapter3_samples_energy_samples> energy_samples;
  };
  struct Readback {
    gpu::BufferPtr buffer;
    Stats stats;
  };

  void make_solvers();
  void build_levels();
  void build_readback();
  using Push = shaders::thesis_chapter3_setup::Push;  // that of nearly all
  Push push_for(size_t level) const;
  void pack(gpu::Commands& commands, size_t level, int slot);
  void begin(gpu::Commands& commands);
  void build_pyramid(gpu::Commands& commands, const Plane& frame, const KnownReflectance* known);
  void downsample(gpu::Commands& commands, size_t level, const gpu::BufferPtr& fine,
                  const gpu::BufferPtr& coarse);
  void start(gpu::Commands& commands, size_t level);
  void find_clusters(gpu::Commands& commands);
  void solve(gpu::Commands& commands, size_t level);
  void conjugate_gradients(gpu::Commands& commands, size_t level, bool first);
  void schwarz(gpu::Commands& commands, size_t level, int step);
  void evaluate(gpu::Commands& commands, size_t level, int step);
  void store_keyframe(gpu::Commands& commands);
  void write_layers(gpu::Commands& commands, Layers& layers);
  void read_back(gpu::Commands& commands, const gpu::BufferPtr& target);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  Params params_;
  Palette palette_;
  ScaleNormalization scale_;
  PlanePool pool_;
  gpu::Program<shaders::thesis_chapter3_sanitize> sanitize_;
  gpu::Program<shaders::thesis_chapter3_downsample> downsample_;
  gpu::Program<shaders::thesis_chapter3_start> start_;
  gpu::Program<shaders::thesis_chapter3_prolong> prolong_;
  gpu::Program<shaders::thesis_chapter3_pack> pack_;
  gpu::Program<shaders::thesis_shared_scalars> scalars_kernel_;
  gpu::Program<shaders::thesis_chapter3_total> total_;
  gpu::Program<shaders::thesis_chapter3_layers> layers_;
  gpu::Program<shaders::thesis_chapter3_scale_cells> scale_cells_;
  /// The kernels of a formulation.
  struct Solver {
    gpu::Program<shaders::thesis_chapter3_setup> setup;
    gpu::Program<shaders::thesis_chapter3_reweight> reweight;
    gpu::Program<shaders::thesis_chapter3_direction> direction;
    gpu::Program<shaders::thesis_chapter3_update> update;
    gpu::Program<shaders::thesis_chapter3_schwarz> schwarz;
    gpu::Program<shaders::thesis_chapter3_energy> energy;
  };
  std::array<Solver, 2> solvers_;  // without strokes, with
  const Solver& solver() const { return solvers_[strokes_.empty() ? 0 : 1]; }
  ThesisStrokeTerm strokes_;
  ThesisKnownTerm known_;
  // Shared by all levels, of the finest level's size.
  gpu::BufferPtr links_, sources_, constant_sources_, edges_, nodes_, preconditioned_, products_,
      clusters_, target_scale_;
  std::array<gpu::BufferPtr, 2> directions_;
  gpu::BufferPtr partials_, scalars_, energy_partials_, sample_partials_, trace_;
  std::vector<Level> levels_;
  Plane solution_;
  gpu::FrameRing<Readback> readback_;
  Stats* current_ = nullptr;  // of the frame being recorded
  bool cleared_ = false;
  uint64_t recorded_ = 0;     // frames since construction
  uint32_t since_reset_ = 0;  // frames since the last reset
  int stored_keyframes_ = 0;  // since the last reset
};

}  // namespace inverse
