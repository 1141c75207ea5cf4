// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cmath>
#include <memory>
#include <optional>

#include "kernels/intrinsic/depth/depth_cue.hpp"
#include "kernels/intrinsic/guide/guide.hpp"
#include "kernels/intrinsic/prior/network/prior_network.hpp"
#include "kernels/intrinsic/strokes/strokes.hpp"
#include "kernels/intrinsic_prior_cell_values.spv.hpp"
#include "kernels/intrinsic_prior_change.spv.hpp"
#include "kernels/intrinsic_prior_edges.spv.hpp"
#include "kernels/intrinsic_prior_fold_biases.spv.hpp"
#include "kernels/intrinsic_prior_save_reference.spv.hpp"

namespace inverse {

/// Weights every edge by how much of its step is reflectance or shading, and sets the value prior
/// of every cell (energy.glsl: a, b, v, V, g), by two small fitted functions of local cues
/// (docs/reference/methods/intrinsicdecomp.md, 2), and a network that adds to that of cells. Can
/// reuse the edges of unchanged tiles. The solver only reads the three buffers of Target: another
/// prior can replace this one.
class EdgePrior {
 public:
  struct Params {
    /// Factor on a, how firmly reflectance stays even across an edge; 1e-3…1e3.
    float reflectance_weight = 1.0F;
    /// Factor on b, how firmly shading stays even; 1e-3…1e3.
    float shading_weight = 1.0F;
    /// Factor on v, how firmly the largest channel of reflectance stays near 1; 1e-3…1e3. Pins the
    /// free scale.
    float value_weight = 1.0F;
    /// Factor on g, how firmly equal chroma means equal reflectance; 0…1e3, 0 switches the chroma
    /// bins off.
    float chroma_weight = 1.0F;
    /// How much a remembered scene's surfaces change b (DepthCue); 0…4, 0 switches that off.
    float depth_weight = 1.0F;
    /// Adds to the fitted functions; null: nothing does.
    PriorModelPtr network = nullptr;
    /// Frames that one run of it may serve (NetworkRate), 1…8.
    uint32_t network_interval = 1;
    bool operator==(const Params&) const = default;
  };
  /// Output buffers. Edges stay there from frame to frame.
  struct Target {
    gpu::BufferPtr system;  ///< three vec4 a pack; the first two are a + b to the right and down
    gpu::BufferPtr flux;    ///< two vec4 a pack: a (m_x - m_y) to the right and down
    gpu::BufferPtr value;   ///< three vec4 a pack of cells: v, V, g
    const Strokes* strokes = nullptr;  ///< change what was written; null: none
    DepthCue* depth = nullptr;         ///< changes it before; null: nothing does
  };
  static constexpr uint64_t kFluxStride = shaders::intrinsic_prior_edges::FLUX_STRIDE,
                            kValueStride = shaders::intrinsic_prior_cell_values::VALUE_STRIDE;
  /// The largest g that it writes, for a chroma_weight of 1.
  static float max_chroma() {
    using Shader = shaders::intrinsic_prior_cell_values;
    return Shader::kCellArea * std::exp(Shader::kLogHigh);
  }

  EdgePrior(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Makes kernels and buffers for a network, as the first frame with it does otherwise.
  void prepare(const PriorModelPtr& network);
  /// Records all edges and values. `keep`: saves the guide for a later `record_changes`.
  void record(gpu::Commands& commands, const Guide& guide, const Target& target,
              const Params& params, bool keep = false);
  /// As `record`, but reuses the edges of tiles of 16 x 16 pixels whose 2 x 2 means of the guide
  /// are within `tolerance` (log units) of the saved ones. Evaluates all the first time, and after
  /// another target or other params.
  void record_changes(gpu::Commands& commands, const Guide& guide, const Target& target,
                      const Params& params, float tolerance);
  /// Forgets the saved guide, and what the network said.
  void reset() {
    known_ = false;
    if (learned_) learned_->network.reset();
  }
  /// How many frames before the last one recorded the network ran; 0 without one.
  uint32_t network_age() const { return learned_ ? learned_->network.age() : 0; }
  uint32_t network_runs() const { return learned_ ? learned_->network.runs() : 0; }
  /// How many tiles a frame has.
  uint32_t tiles() const { return changes_.tiles(); }
  /// Words; the first is how many tiles the last `record_changes` evaluated.
  const gpu::BufferPtr& evaluated() const { return changes_.words(); }

 private:
  using Edges = TileProgram<shaders::intrinsic_prior_edges>;
  using Values = gpu::Program<shaders::intrinsic_prior_cell_values>;
  /// What takes the place of `values_` with a network.
  struct Learned {
    Learned(const std::shared_ptr<gpu::Device>& device, Extent extent, const PriorModelPtr& model);
    PriorNetwork network;
    Values values;
  };
  /// What comes before edges and values. If no tile is `listed`, what the network said stays.
  void record_frame(gpu::Commands& commands, const Guide& guide, const Params& params,
                    const TileList* listed);
  void record_edges(gpu::Commands& commands, const Guide& guide, const Target& target,
                    const Params& params, const TileList* listed) const;
  void record_values(gpu::Commands& commands, const Guide& guide, const Target& target,
                     const Params& params) const;

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  gpu::Program<shaders::intrinsic_prior_fold_biases> fold_biases_;
  gpu::Program<shaders::intrinsic_prior_change> change_;
  Edges edges_[2];  // to the right, down
  Values values_;
  TileProgram<shaders::intrinsic_prior_save_reference> save_reference_;
  std::optional<Learned> learned_;
  TileList changes_;
  gpu::BufferPtr same_;  // a word: 0
  gpu::BufferPtr biases_, kept_, kept_statistics_;
  Params known_params_;
  gpu::BufferPtr known_system_;
  bool known_ = false;
};

}  // namespace inverse
