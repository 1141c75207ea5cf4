// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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

namespace inverse {

/// Reflectance, direct and indirect light of every frame of a video
/// (docs/reference/methods/globalintrinsic.md): what light is indirect, and of what color, the
/// image itself predicts, as its surfaces are the emitters; one amount for the scene and its base
/// colors are measured; the tint that follows is divided out, and ScaledIntrinsic decides how
/// bright reflectance and light are. Takes the place of chapter 5's energy (that takes the place of
/// chapter 3's). For one size on one device. Not thread-safe.
class GlobalIntrinsic {
 public:
  /// Values outside their range are clamped.
  struct Params : ScaledIntrinsic::Params {
    /// Standard deviation of how far surfaces light each other, 0.02…2 of the frame's width.
    float reach = 0.4F;
    /// Share of that beside light that comes from all over the frame, 0…1.
    float near = 0.7F;
    /// Share of a surface's own color that does not light it, 0…0.95: a plane sees none of itself.
    float own = 0.8F;
    /// The amount of indirect light, 0.01…2; 0: measured.
    float amount = 0;
    /// Of the measurement: weight of neutrality beside sharpness of chroma; the amount of a scene
    /// that says nothing, and how much scenes differ (standard deviation of its ln); how much a
    /// difference says where chroma spreads by full_trust or more; below that, in proportion.
    float neutral = 1.5F, typical = 0.5F, spread = 0.65F, trust = 8, full_trust = 0.35F;
    /// Base colors at most, 1…16; share of the frame that one needs, 0…0.5; chroma (log units) up
    /// to which one continues a color of the frame before.
    int base_colors = 16;
    float least_share = 0.004F, same_color = 0.3F;
    /// Share of the newest frame in what is measured of the scene, 0.01…1.
    float renew = 0.2F;
    /// Share of the lamps' estimated color that is taken out first, 0…1.
    float white_balance = 0;
    /// Mean change of chroma, in halves of a log unit, from which on a frame is a cut, 0…1.
    float cut = 0.3F;
    /// Standard deviation of the smoothing of the histogram of chroma, in bins of 0.08, 0.5…2.5.
    float smoothing = 1.2F;
    /// Share of the slowly varying rest of chroma that is taken for light in tinted scenes, 0…1.
    float residual = 1;
    /// How far chroma spreads over the frame (standard deviation, log units) where there is no
    /// color to go by, and all light counts as direct, 0…1; and from where on there is. `amount`
    /// set by hand goes without.
    float no_color = 0.03F, full_color = 0.06F;
    bool operator==(const Params&) const = default;
  };
  struct FrameInfo {
    bool reset = false;   ///< no relation to the frame before (discontinuity)
    bool shares = false;  ///< somebody needs indirect light as one layer for each base color
    /// As IntrinsicDecomposition::FrameInfo::changed.
    std::span<const uint8_t> changed = {};
  };
  struct Stats {
    ScaledIntrinsic::Stats solve;
    bool first = false;  ///< nothing of an earlier frame was known
    bool plain = false;  ///< there was no color to go by: all was left out but the solve
    bool held = false;   ///< the scene's light is that of the frame before, but for what changed
  };
  struct Findings {
    ScaledIntrinsic::Findings solve;
    float amount = 0;      ///< of indirect light
    float confidence = 0;  ///< of the amount: 0 the image says nothing, 1 it leaves no doubt
    uint32_t colors = 0;   ///< base colors
    float tint = 0;        ///< rms log chroma of light that is all indirect
    bool cut = false;      ///< of the scene: nothing was taken over from the frame before
    float chroma = 0;      ///< how far it spreads over the frame, log units
    /// Base colors by their slot: linear, largest channel 1; black where there is none.
    std::array<std::array<float, 3>, kMaxBases> bases{};
  };

  /// Throws Error(limit) where frames of this size do not fit the device.
  GlobalIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent);

  /// Records the decomposition of `input` (linear RGB, 1 = full scale; w = alpha) and returns its
  /// layers: input, intrinsic and model (R.rgb, S), light and model_light (color of light, the
  /// lamps' included; direct share), and where they are asked for base colors and their shares. Who
  /// edits in place copies first what others hold. The frame kFramesInFlight before this one must
  /// have been waited for.
  Layers record(gpu::Commands& commands, const PlanePtr& input, const Params& asked,
                const FrameInfo& info);
  /// Draws the frame that was recorded last, every pixel in the base color that it counts as
  /// (linear RGB, largest channel 1, w = 1); gray where the scene has none.
  void draw_labels(gpu::Commands& commands, const Plane& input, const Plane& target);
  /// Sets up a resolution before it is first asked for (ScaledIntrinsic::prepare).
  void prepare(size_t halvings) { solve_.prepare(halvings); }
  /// As ScaledIntrinsic::warm_up, which it includes.
  bool warm_up() const;
  /// As ScaledIntrinsic::drawn.
  const TileList* drawn() const { return drawn_; }
  /// As ScaledIntrinsic::fading.
  bool fading() const { return solve_.fading(); }
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
  /// Points of the grid, and whether the frame continues the one before.
  /// Returns the layer of the lamps' color where that is taken out.
  PlanePtr look(gpu::Commands& commands, const PlanePtr& frame, const Params& params, bool plain);
  /// Whether the last frames had no color to go by: then only that is looked at.
  bool colorless(const Params& params);
  /// The scene of a frame: amount, base colors and the tint at the points of the grid.
  void find_scene(gpu::Commands& commands, const Params& params);
  PlanePtr white_light(gpu::Commands& commands);
  /// The frame's layers by what was found of the scene.
  Layers record_light(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                      const FrameInfo& info);
  /// How a frame gets the color of its light.
  enum class Tint : uint8_t {
    anew,  ///< measured
    kept,  ///< measured, and kept for the next one
    held,  ///< that of the frame before, but for tiles that changed
  };
  Tint next_tint(const Params& params, const FrameInfo& info);
  /// Frames in a row without color to go by after which that alone is looked at.
  static constexpr uint32_t kRest = 8;
  /// Frames in a row, each with at most this share of its tiles changed or beside such, after which
  /// the scene's light is held.
  static constexpr uint32_t kCalm = 12;
  static constexpr float kMostChanged = 0.25F;
  /// Of an object of its own (warm_up.cpp): records all that can come. Whether it came.
  bool play_all();
  void record_tint(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                   const PlanePtr& plain, const PlanePtr& tau);
  PlanePtr record_direct(gpu::Commands& commands, const PlanePtr& plain, const PlanePtr& tau,
                         const Layers& layers);
  /// Light that surfaces of every base color receive: of those of the frame before or, `known`, of
  /// this one's.
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
  ScaledIntrinsic solve_;
  PlanePool planes_, bases_, lamps_;
  /// Named as their shaders.
  struct Kernels {
    using Grid = gpu::Program<shaders::global_grid_grid>;
    using Look = gpu::Program<shaders::global_grid_scene_statistics>;
    Grid grid[2], plain_grid;              // in white light and in the lamps'; of colors alone
    Look decide_and_start, decide, start;  // whole and in two halves
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
    gpu::Program<shaders::global_light_label_confidence> believe;
    gpu::Program<shaders::global_light_fit> fit[3];
    TileProgram<shaders::global_light_divide_tint> untint;
    TileProgram<shaders::global_light_direct> direct;
  } kernels_;
  gpu::BufferPtr memory_;                                                        // pixels
  gpu::BufferPtr colors_, points_, before_, labels_, tints_, raw_, fits_[3];     // the grid
  gpu::BufferPtr emitted_, blurred_, received_, known_, means_, taps_, fields_;  // the coarse grid
  gpu::BufferPtr candidates_, counts_, histogram_, heights_, work_, slots_;      // chroma
  gpu::BufferPtr sums_, scene_;
  float reach_ = 0;  // that taps_ are of
  gpu::FrameRing<Report> reports_;
  uint64_t recorded_ = 0;
  uint64_t frames_ = 0;  // since a reset
  bool balanced_ = false;
  uint32_t gray_ = 0;    // frames in a row without color to go by, as far as known
  bool rested_ = false;  // the frame before was
  PlanePtr white_light_;
  // Of video of which little changes.
  Tint mode_ = Tint::anew;          // of the frame being recorded
  uint32_t calm_ = 0;               // frames in a row
  std::vector<uint8_t> concerned_;  // tiles that changed, and those beside them
  std::vector<uint8_t> seen_;       // tiles that changed since the scene was last looked at
  gpu::FrameRing<std::optional<TileList>> changed_;
  Params params_;  // of the frame before
  PlanePtr kept_plain_, kept_tau_, kept_light_, kept_lamp_, kept_bases_;
  const TileList* drawn_ = nullptr;
};

}  // namespace inverse
