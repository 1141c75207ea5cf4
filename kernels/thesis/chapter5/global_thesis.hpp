// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "global_thesis_params.hpp"
#include "kernels/gpu/commands.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/image/plane.hpp"
#include "kernels/palette/palette.hpp"
#include "kernels/thesis/chapter5/colors/base_colors.hpp"
#include "kernels/thesis/chapter5/regions/marked_regions.hpp"
#include "kernels/thesis_chapter5_setup_setup.spv.hpp"

namespace inverse {

/// The global intrinsic video decomposition of the thesis, chapter 5, for frames of one size: into
/// reflectance, direct light and one layer of indirect light for each base color. The energy and
/// the systems are in energy.glsl. Keeps keyframes, palette and base colors from frame to frame.
///
/// The base colors live on the host, because the kernels are built for their number. A frame is
/// decomposed with the base colors known when it is recorded. Its own palette, and the system that
/// refines the colors, are read by `collect` when the device is done with it, so that no frame
/// waits. To decompose the first frame with its own colors, call `record_colors`, wait, and call
/// `collect_colors` before.
///
/// A scene cut is found in the same way when its frame is collected. From the next frame on,
/// keyframes and palette are those of the new scene. The base colors of the old scene are used
/// until that frame's palette is known. Given base colors stay.
class GlobalThesis {
 public:
  using Params = GlobalThesisParams;
  using Rgb = BaseColors::Rgb;

  /// Energy by term, summed over pixels.
  struct Energy {
    int step;  ///< after which it was taken; −1 is the start
    float data, clustering, r_sparsity, r_consistency;
    float monochrome, i_sparsity, smoothness, non_negativity;
    double total() const {
      return static_cast<double>(data) + clustering + r_sparsity + r_consistency + monochrome +
             i_sparsity + smoothness + non_negativity;
    }
  };

  struct Stats {
    int layers = 0;              ///< K: indirect layers of the frame
    int colors = 0;              ///< base colors, with those too near to white for a layer
    int steps = 0;               ///< Gauss–Newton steps
    int pcg_iterations = 0;      ///< for each
    int keyframes = 0;           ///< that samples were drawn from
    bool warm = false;           ///< started from the last frame's solution
    bool refining = false;       ///< the frame recorded the system of the base colors
    int shortened = 0;           ///< steps, because they would have raised the energy
    std::vector<Energy> energy;  ///< as Params::energy and Params::trace ask for
    bool cut = false;            ///< found when the frame was collected
    float change = 0;            ///< of chroma from the frame before, unit of Params::cut_chroma
    float score = 0;             ///< Σ_k |T_k| over the region asked for in `record` (5.5.2.2)
    float region = 0;            ///< its pixels
  };

  /// Throws Error(limit, out_of_memory).
  GlobalThesis(const std::shared_ptr<gpu::Device>& device, Extent extent);

  /// Maximum number of indirect layers for frames of this size on this device: a multiple of 4, up
  /// to kMaxBases; 0 or less if the device cannot hold such frames. Limits Params::clusters.
  static int max_layers(const gpu::Device& device, Extent extent);

  /// Takes effect with the next frame. A change of keyframes discards all frames before.
  void set_params(const Params& params);
  const Params& params() const { return params_; }

  /// Optional input of `record`.
  struct Hints {
    MarkedRegions* regions = nullptr;  ///< of the same size; tracked in this frame
    /// Instead of `regions`: (slot or −1, number or 0) of every pixel.
    const Plane* fixed_regions = nullptr;
    int scored_region = 0;  ///< number of the region of Stats::score; 0: none

    gpu::BufferPtr buffer() const {
      return regions ? regions->plane().buffer : fixed_regions->buffer;
    }
  };

  /// Decomposes `frame` (linear RGB, full scale 1, any values; w is ignored) with the present base
  /// colors. Writes Role::intrinsic = (R, S), S the mean of the shading; Role::light = (color of
  /// the light Σ_k b_k T_k / S, T_0 / S); the roles of indirect light = T_k / S, four layers a
  /// plane; Role::bases = b_1 … b_K; and the same planes as model. R has the scale of the base
  /// colors, whose largest channel is 1. Returns the frame's number for `collect` and `stats`.
  /// Throws Error(out_of_memory).
  uint64_t record(gpu::Commands& commands, const Plane& frame, Layers& layers, const Hints& hints);
  uint64_t record(gpu::Commands& commands, const Plane& frame, Layers& layers) {
    return record(commands, frame, layers, Hints{});
  }
  /// Finds the base colors of `frame` without decomposing it. Not a frame for `collect` or `stats`.
  void record_colors(gpu::Commands& commands, const Plane& frame);
  /// Reads them back. Wait for the Commands of `record_colors` first.
  void collect_colors();

  /// Reads the base colors of one of the last three frames. Wait for its Commands first. Does
  /// nothing for frames that are older or were collected before.
  void collect(uint64_t frame);

  /// Statistics of one of the last three frames. Wait for its Commands first. Empty before the
  /// first frame; throws Error(internal) for older ones.
  Stats stats(uint64_t frame) const;

  /// Uses these base colors (linear, any scale) until `reset`. Throws Error(limit) if they are more
  /// than `max_layers`.
  void set_base_colors(std::span<const Rgb> colors);
  /// Uses the base colors of another decomposition, with their slots, until `reset`.
  void set_base_colors(const BaseColors& colors);
  const BaseColors& colors() const { return colors_; }

  /// Refines the base colors again, for at most Params::refine_rounds frames.
  void refine() { rounds_ = 0; }
  bool refining() const { return rounds_ < params_.refine_rounds && colors_.layers() > 0; }
  /// Number of the first frame recorded with base colors of the present scene: 0 before the first
  /// cut, UINT64_MAX between a cut and the first base colors after it.
  uint64_t scene_since() const { return scene_since_; }
  /// Discards keyframes, palette and base colors, for a flush or a discontinuity.
  void reset();

  /// The field of the last frame, plane behind plane: (r, T_0), T_1 … T_4, …. Valid until the next
  /// record.
  const gpu::BufferPtr& solution() const { return states_[current_state_]; }
  /// (r_cluster, λ_clustering) and (packed chromaticity, …) of the last frame.
  const gpu::BufferPtr& targets() const { return targets_; }
  const gpu::BufferPtr& features() const { return features_; }
  /// The last frame with negative and non-finite values replaced. Valid until the next record.
  Plane image() const { return {extent_, image_}; }
  Extent extent() const { return extent_; }

  /// Makes the kernels for all numbers of base colors and the present parameters. Without it, the
  /// first frame that needs a kernel makes it.
  void make_kernels();

  /// Device memory of a pixel with K layers, in bytes.
  static uint64_t bytes_per_pixel(int layers, int keyframes);

 private:
  /// Of all kernels (energy.glsl).
  using Push = shaders::thesis_chapter5_setup_setup::Push;
  struct Kernels;
  /// What of a frame is run. A plain value: stages obey it.
  struct Plan {
    bool warm = false;            ///< starts from the last solution, which has the same layers
    bool measure_change = false;  ///< of chroma, for cuts
    bool has_change = false;      ///< the frame before was measured, too
    bool regions = false;         ///< overrule clusters
    bool search = false;          ///< for the length of every step
    bool store_keyframe = false;
    bool refine = false;  ///< sums the system of the base colors
    bool score = false;   ///< measures how sparse the light of a region is
  };
  struct Readback {
    gpu::BufferPtr buffer, table;
    Stats stats;
    std::vector<Rgb> initial, colors;  // of the layers that the system is for
    Plan plan;
    bool collected = true;
    uint32_t version = 0;  // of the colors that the system is for
    uint32_t epoch = 0;    // of the resets
  };

  const Kernels& kernels(int groups);
  void hold_frames(int slots_per_buffer);
  void hold_fields(int groups);
  Push push_for() const;
  void check_size(const Plane& frame) const;
  void clear(Readback& readback) const;
  void forget_frames();
  void cut();
  Plan plan_frame(const Hints& hints) const;
  void begin(gpu::Commands& commands, const Hints& hints);
  void prepare(gpu::Commands& commands, const Plane& frame);
  void measure_change(gpu::Commands& commands, uint64_t number);
  void set_up(gpu::Commands& commands, const Hints& hints);
  void pack(gpu::Commands& commands, int slot);
  void evaluate(gpu::Commands& commands, int step);
  void hold_energies(gpu::Commands& commands);
  void sum_energy(gpu::Commands& commands, const gpu::BufferPtr& x);
  void check_step(gpu::Commands& commands, const gpu::BufferPtr& x, int mode);
  void search(gpu::Commands& commands);
  template <typename Shader>
  void reduce(gpu::Commands& commands, int mode, const gpu::Program<Shader>& program,
              gpu::Items items);
  void conjugate_gradients(gpu::Commands& commands);
  void step(gpu::Commands& commands);
  void solve(gpu::Commands& commands);
  void record_refinement(gpu::Commands& commands);
  void score_region(gpu::Commands& commands, const Hints& hints);
  void write_layers(gpu::Commands& commands, Layers& layers);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  int max_layers_ = 0;
  Params params_;
  Palette palette_;
  PlanePool pool_, bases_pool_;
  BaseColors colors_;
  std::array<std::shared_ptr<Kernels>, 5> kernels_;  // by planes of indirect layers
  const Kernels* at_ = nullptr;                      // of the frame being recorded
  int groups_ = 0;                                   // of it
  int held_groups_ = -1;                             // that the fields have room for
  gpu::BufferPtr image_, chroma_, targets_, features_, sources_, constant_sources_, nodes_,
      pixel_products_;
  // Fields.
  std::array<gpu::BufferPtr, 2> states_;
  gpu::BufferPtr directions_, preconditioned_, products_, diagonals_;
  size_t current_state_ = 0;
  gpu::BufferPtr scalars_, partials_;
  std::array<gpu::BufferPtr, 3> energy_partials_;
  gpu::BufferPtr search_, rescale_;  // as in search.comp
  gpu::BufferPtr trace_, residuals_, reflectances_, outer_partials_, system_, score_;
  std::vector<gpu::BufferPtr> frames_;  // sample frames, slots_ to a buffer
  int slots_ = 0;
  gpu::FrameRing<Readback> readback_;
  Readback colors_readback_;     // of record_colors
  Readback* current_ = nullptr;  // of the frame being recorded
  uint64_t recorded_ = 0;        // frames since construction
  uint64_t collected_ = 0;       // the oldest frame that may still change the base colors
  uint32_t since_reset_ = 0;     // frames since the last reset
  uint32_t epoch_ = 0;           // resets
  int stored_keyframes_ = 0;     // since the last reset
  int rounds_ = 0;               // of refinement
  bool system_pending_ = false;  // a recorded system is not collected
  uint32_t state_order_ = 0;     // of the colors that the solution is for
  bool has_state_ = false;
  gpu::BufferPtr cells_, change_;  // of this frame and the one before, by the parity of its number
  bool compared_ = false;          // the frame before
  uint64_t scene_since_ = 0;
};

}  // namespace inverse
