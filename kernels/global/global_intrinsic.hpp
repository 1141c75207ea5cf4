// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>

#include "kernels/global_gather_blur.spv.hpp"
#include "kernels/global_gather_emit.spv.hpp"
#include "kernels/global_gather_fields.spv.hpp"
#include "kernels/global_gather_received.spv.hpp"
#include "kernels/global_gather_summary.spv.hpp"
#include "kernels/global_grid_grid.spv.hpp"
#include "kernels/global_grid_scene_statistics.spv.hpp"
#include "kernels/global_grid_white.spv.hpp"
#include "kernels/global_light_direct.spv.hpp"
#include "kernels/global_light_divide_tint.spv.hpp"
#include "kernels/global_light_fit.spv.hpp"
#include "kernels/global_light_label_confidence.spv.hpp"
#include "kernels/global_light_labels.spv.hpp"
#include "kernels/global_light_shares.spv.hpp"
#include "kernels/global_scene_amount.spv.hpp"
#include "kernels/global_scene_modes.spv.hpp"
#include "kernels/global_scene_statistics.spv.hpp"
#include "kernels/global_scene_tint.spv.hpp"
#include "kernels/global_scene_weigh.spv.hpp"
#include "kernels/image/layers.hpp"
#include "kernels/intrinsic/scaled_intrinsic.hpp"
#include "kernels/reuse/light_planner.hpp"

namespace inverse {

/// Reflectance, direct and indirect light of every frame of a video
/// (docs/reference/methods/globalintrinsic.md). Predicts color and place of indirect light from the
/// image, whose surfaces emit it; measures its amount and the scene's base colors; divides the
/// resulting tint out of the frame; and decomposes the rest by ScaledIntrinsic. For one size on one
/// device. Not thread-safe.
class GlobalIntrinsic {
 public:
  /// Values outside their range are clamped.
  struct Params : ScaledIntrinsic::Params {
    /// Standard deviation of the distance over which surfaces light each other, 0.02…2 frame
    /// widths.
    float reach = 0.4F;
    /// Share of near indirect light, 0…1; the rest comes from the whole frame.
    float near_share = 0.7F;
    /// Share of a surface's own color that does not light it, 0…0.95: a plane does not light
    /// itself.
    float own = 0.8F;
    /// The amount of indirect light, 0.01…2; 0: measured.
    float amount = 0;
    /// Measurement of the amount: weight of neutral chroma against sharp modes of chroma.
    float neutral = 1.5F;
    /// Its prior: median, and standard deviation of ln.
    float typical_amount = 0.5F, spread = 0.65F;
    /// Weight of the measurement against the prior, reached if chroma spreads by full_spread (log
    /// units) or more; proportionally less below.
    float measurement_weight = 8, full_spread = 0.35F;
    /// Maximum number of base colors, 1…16.
    int base_colors = 16;
    /// Minimum share of the frame of a base color, 0…0.5; distance of chroma (log units) up to
    /// which it continues one of the frame before.
    float min_share = 0.004F, same_color = 0.3F;
    /// Share of the newest frame in estimates of the scene, 0.01…1.
    float update_rate = 0.2F;
    /// Share of the lamps' estimated color that is removed first, 0…1.
    float white_balance = 0;
    /// Mean change of chroma, in halves of a log unit, at which a scene cut is detected, 0…1.
    float cut_chroma = 0.3F;
    /// Standard deviation of the smoothing of the histogram of chroma, in bins of 0.08, 0.5…2.5.
    float smoothing = 1.2F;
    /// Share of the slowly varying residual of chroma that counts as light in tinted scenes, 0…1.
    float residual = 1;
    /// Spread of chroma over the frame (standard deviation, log units, 0…1) below which all light
    /// counts as direct, and above which none does for lack of color. Not used if `amount` is set.
    float no_color = 0.03F, full_color = 0.06F;
    bool operator==(const Params&) const = default;
  };
  struct FrameInfo {
    bool reset = false;   ///< no relation to the frame before (discontinuity)
    bool shares = false;  ///< make one layer of indirect light for each base color
    /// As in IntrinsicDecomposition::FrameInfo.
    bool repeated = false;
    StrokesPtr strokes = {};
    const StrokeTracker* tracker = nullptr;
    const SeenStrokes* seen = nullptr;
    const KnownReflectance* known = nullptr;
  };
  struct Stats {
    ScaledIntrinsic::Stats solve;
    bool first = false;  ///< the first one since the start or a reset
    LightPlanner::Plan light;
  };
  struct Findings {
    ScaledIntrinsic::Findings solve;
    float amount = 0;      ///< of indirect light
    float confidence = 0;  ///< of the amount, 0…1
    uint32_t colors = 0;   ///< base colors
    float tint = 0;        ///< rms log chroma of light that is all indirect
    bool cut = false;      ///< a scene cut: nothing of the frame before was used
    float chroma = 0;      ///< spread over the frame (standard deviation, log units)
    /// Base colors by their slot: linear, largest channel 1; black if the slot is free.
    std::array<std::array<float, 3>, kMaxBases> bases{};
  };

  /// Throws Error(limit) if frames of this size do not fit the device.
  GlobalIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent);

  /// Records the decomposition of `input` (linear RGB, 1 = full scale; w = alpha) and returns its
  /// layers: input, intrinsic and model (R.rgb, S), light and model_light (color of light, the
  /// lamps' included; direct share), and with FrameInfo::shares base colors and their shares. Copy
  /// a plane before editing it in place if others hold it. The frame kFramesInFlight before this
  /// one must have been waited for.
  Layers record(gpu::Commands& commands, const PlanePtr& input, const Params& asked,
                const FrameInfo& info);
  /// Draws every pixel of the frame recorded last in its base color (linear RGB, largest channel 1,
  /// w = 1); gray if the scene has none.
  void draw_labels(gpu::Commands& commands, const Plane& input, const Plane& target);
  /// Sets up a resolution for good (ScaledIntrinsic::prepare).
  void prepare(size_t halvings, const PriorModelPtr& network = nullptr) {
    solve_.prepare(halvings, network);
  }
  /// As ScaledIntrinsic::converged.
  bool converged(uint64_t frame, const Params& params) const {
    return solve_.converged(report(frame).solve, params);
  }
  /// Forgets the frames so far (flush, discontinuity).
  void reset();
  /// Frames recorded since construction.
  uint64_t recorded() const { return recorded_; }
  /// Of one of the last kFramesInFlight frames.
  const Stats& stats(uint64_t frame) const { return report(frame).stats; }
  /// Of one of the last kFramesInFlight frames, once its Commands have been waited for.
  Findings findings(uint64_t frame) const;

 private:
  struct Report {
    Stats stats;
    uint64_t solve = 0;      // its number there
    gpu::BufferPtr found;    // the scene's buffer
    uint32_t slots() const;  // up to the last base color
  };
  const Report& report(uint64_t frame) const { return reports_[frame]; }
  /// The push constants of shaders that need nothing but sizes.
  shaders::global_gather_emit::Push sizes() const {
    return {.size = extent_, .grid = grid_, .coarse = coarse_, .factor = factor_};
  }
  shaders::global_light_labels::Push row_sizes() const {
    return {.size = extent_, .grid = grid_, .coarse = coarse_, .factor = factor_, .first_row = 0};
  }
  void measure_light_color(gpu::Commands& commands, const Plane& input, const Params& params);
  /// The color of the frame's light; null if it is gray.
  SceneLight* colored_light() { return colored_ ? &light_color_ : nullptr; }
  const gpu::BufferPtr& light_state() const {
    return colored_ ? light_color_.state() : gray_light_;
  }
  LightPlanner::Plan plan_light(const Params& params, const FrameInfo& info);
  /// Measures the points of the grid, scene cuts and the lamps' color. Returns the layer of the
  /// lamps' color if that is removed.
  PlanePtr measure_grid(gpu::Commands& commands, const PlanePtr& frame, const Params& params,
                        bool was_gray);
  /// The scene of a frame: amount, base colors and the tint at the points of the grid.
  void find_scene(gpu::Commands& commands, const Params& params);
  PlanePtr white_light(gpu::Commands& commands);
  /// The layers of a gray scene, and of others.
  Layers record_gray(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                     const FrameInfo& info);
  Layers record_light(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                      const FrameInfo& info);
  void record_tint(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                   const PlanePtr& neutral_input, const PlanePtr& tau);
  PlanePtr record_direct(gpu::Commands& commands, const PlanePtr& neutral_input,
                         const PlanePtr& tau, const Layers& layers);
  void record_report(gpu::Commands& commands, bool first);
  /// Light that surfaces of every base color receive: by the base colors of the frame before or, if
  /// `known`, of this one.
  void gather(gpu::Commands& commands, const Params& params, bool known);
  void measure_amount(gpu::Commands& commands, const Params& params);
  void find_tint(gpu::Commands& commands, const Params& params);
  void find_colors(gpu::Commands& commands, const Params& params);
  void find_residual(gpu::Commands& commands);
  void make_taps(const Params& params);
  uint32_t planes_needed(const Params& params) const;
  void share_out(gpu::Commands& commands, Layers& layers, uint32_t count);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_, grid_, coarse_;
  int32_t factor_ = 1;
  SceneLight light_color_;
  bool colored_ = false;  // the frame's light
  ScaledIntrinsic solve_;
  PlanePool planes_, bases_, lamps_;
  /// Named as their shaders.
  struct Kernels {
    using Grid = gpu::Program<shaders::global_grid_grid>;
    using SceneStatistics = gpu::Program<shaders::global_grid_scene_statistics>;
    Grid grid[2], color_grid;  // in white light and in the lamps'; of colors alone
    SceneStatistics decide_and_start, decide, start;  // whole and in two halves
    gpu::Program<shaders::global_grid_white> white;
    gpu::Program<shaders::global_gather_emit> emit[2];
    gpu::Program<shaders::global_gather_summary> summary;
    gpu::Program<shaders::global_gather_blur> blur[2];
    gpu::Program<shaders::global_gather_received> received;
    gpu::Program<shaders::global_gather_fields> fields;
    gpu::Program<shaders::global_scene_amount> amount;
    gpu::Program<shaders::global_scene_weigh> weigh;
    gpu::Program<shaders::global_scene_tint> tint;
    gpu::Program<shaders::global_scene_statistics> statistics;
    gpu::Program<shaders::global_scene_modes> modes;
    gpu::Program<shaders::global_light_label_confidence> label_confidence;
    gpu::Program<shaders::global_light_fit> fit[3];
    gpu::Program<shaders::global_light_shares> shares[kIndirectPlanes];  // by planes, from 1 on
    gpu::Program<shaders::global_light_divide_tint> divide_tint;
    gpu::Program<shaders::global_light_direct> direct;
  } kernels_;
  gpu::BufferPtr memory_;                                                        // pixels
  gpu::BufferPtr colors_, points_, before_, labels_, tints_, raw_, fits_[3];     // the grid
  gpu::BufferPtr emitted_, blurred_, received_, known_, means_, taps_, fields_;  // the coarse grid
  gpu::BufferPtr candidates_, counts_, histogram_, heights_, work_, slots_;      // chroma
  gpu::BufferPtr sums_, scene_, gray_light_;
  float reach_ = 0;  // that taps_ are of
  gpu::FrameRing<Report> reports_;
  uint64_t recorded_ = 0;
  uint64_t frames_ = 0;  // since a reset
  bool balanced_ = false;
  PlanePtr white_light_;
  LightPlanner planner_;
  LightPlanner::Plan plan_;  // of the frame being recorded
  Params params_;            // of the frame before
  /// What Light::measure_keep keeps: the frame without its tint, and its light.
  struct Kept {
    PlanePtr neutral_input, tau, lamp, bases;
  } kept_;
};

}  // namespace inverse
