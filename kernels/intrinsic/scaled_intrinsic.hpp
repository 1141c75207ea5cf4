// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>

#include "intrinsic_decomposition.hpp"
#include "kernels/image/pyramid.hpp"
#include "kernels/intrinsic/resolution/guided_upsample.hpp"
#include "kernels/intrinsic/resolution/layer_distance.hpp"
#include "kernels/intrinsic/resolution/layer_fade.hpp"
#include "kernels/intrinsic/reuse/resolution_planner.hpp"

namespace inverse {

/// IntrinsicDecomposition at the frame's resolution or, for less time, on a frame that is halved
/// once or twice, with guided upsampling of shading. What was found at one resolution carries over
/// to the next: the frame at which it changes is solved at both, and the layers that go out fade
/// from one to the other. Each resolution is set up when it is first needed: `prepare` does it
/// beforehand. Not thread-safe.
class ScaledIntrinsic {
 public:
  struct Params : IntrinsicDecomposition::Params {
    bool half_resolution = false;
    /// With half_resolution: a quarter of width and height instead.
    bool quarter_resolution = false;
    /// Distance of log shading between half and full resolution, rms (LayerDistance), 0…1, below
    /// which half is chosen by itself where `adaptive` is on; 0: never.
    float half_bound = 0.06F;
    /// How often the frame is halved before it is solved, as far as it is not a matter of
    /// half_bound.
    size_t halvings() const { return !half_resolution ? 0 : quarter_resolution ? 2 : 1; }
    void set_halvings(size_t halvings) {
      half_resolution = halvings > 0;
      quarter_resolution = halvings > 1;
    }
    /// Scales all tolerances of skipped work; 0 skips nothing that changes the result.
    void scale_tolerances(float factor) {
      adaptive = adaptive && factor > 0;
      for (float* tolerance : {&settled, &still_tolerance, &chroma_tolerance, &hold_tolerance,
                               &tile_tolerance, &half_bound})
        *tolerance *= factor;
    }
    bool operator==(const Params&) const = default;
  };
  using FrameInfo = IntrinsicDecomposition::FrameInfo;
  struct Stats : IntrinsicDecomposition::Stats {
    size_t halvings = 0;
    bool crossed = false;   ///< solved at the last frame's resolution, too, to carry it over
    bool compared = false;  ///< solved at the other resolution, too, to see what half costs
  };
  struct Findings : IntrinsicDecomposition::Findings {
    float half_distance = 0;  ///< of half from full resolution when last compared; 0: not yet
  };

  ScaledIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent);

  /// Throws Error(limit) where frames of this size do not fit the device.
  void prepare(size_t halvings) {
    set_up(halvings);
    stays_[halvings] = true;
  }
  /// Builds, on a software device, every kernel that frames of any size, resolution and parameters
  /// may come to need (tiles, comparisons, a change of resolution), so that none is built in
  /// mid-stream; once a device. Waits for it; nothing of this object changes. False where its
  /// video did not come to need them all: the rest is then built when frames first do.
  bool warm_up() const;
  /// As IntrinsicDecomposition::record.
  Layers record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                const FrameInfo& info);
  /// As IntrinsicDecomposition::drawn; null where every pixel is drawn from another resolution.
  const TileList* drawn() const { return plain_ > 1 ? methods_[0]->drawn() : nullptr; }
  /// Whether layers still fade from those of another resolution.
  bool fading() const { return fade_.on(); }
  /// Forgets the frames so far (flush, discontinuity).
  void reset();
  uint64_t recorded() const { return recorded_; }
  /// Of one of the last kFramesInFlight frames.
  const Stats& stats(uint64_t frame) const { return taken(frame).stats; }
  /// Of one of the last kFramesInFlight frames, once its Commands have been waited for.
  Findings findings(uint64_t frame) const;

 private:
  static constexpr size_t kResolutions = 3;
  /// The way down to and up from one resolution, from the next finer one.
  struct Step {
    Step(const std::shared_ptr<gpu::Device>& device, Extent fine)
        : halve(device),
          upsample(device, fine),
          inputs(device, half_of(fine)),
          layers(device, fine) {}
    Halve halve;
    GuidedUpsample upsample;
    PlanePool inputs, layers;
  };
  /// What became of one of the last frames: which method took it, and as its how many-th.
  struct Taken {
    Stats stats;
    uint64_t number = 0;
    float half_distance = 0;
  };
  const Taken& taken(uint64_t frame) const { return taken_[frame]; }
  IntrinsicDecomposition& method(size_t halvings) { return *methods_[halvings]; }
  void set_up(size_t halvings);
  /// Of the last frame that is sure to be done; empty if there is none.
  std::optional<ResolutionPlanner::Found> found_before() const;
  /// Half resolution is set up again when it is next used.
  void release_half();
  void start_anew();
  /// What warm_up does (warm_up.cpp). Whether all that can come came.
  bool play_all() const;
  /// The frame's intrinsic plane, solved after `halvings`.
  PlanePtr solve(gpu::Commands& commands, size_t halvings, const PlanePtr& input,
                 const Params& params, const FrameInfo& info);
  void take_over(gpu::Commands& commands, size_t from, size_t to, PlanePtr intrinsic);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  std::array<std::optional<IntrinsicDecomposition>, kResolutions> methods_;
  std::array<std::optional<Step>, kResolutions - 1> steps_;  // [k] from k halvings to k + 1
  std::array<bool, kResolutions> stays_{};                   // set up for good
  std::optional<LayerDistance> distance_;
  LayerFade fade_;
  ResolutionPlanner planner_;
  gpu::FrameRing<Taken> taken_;
  uint64_t recorded_ = 0;
  size_t was_ = 0;      // halvings of the frame before
  unsigned plain_ = 0;  // frames in a row that were solved at full resolution, and shown so
};

}  // namespace inverse
