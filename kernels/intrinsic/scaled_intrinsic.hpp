// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "intrinsic_decomposition.hpp"
#include "kernels/image/pyramid.hpp"
#include "kernels/intrinsic/resolution/guided_upsample.hpp"
#include "kernels/intrinsic/resolution/layer_distance.hpp"
#include "kernels/intrinsic/resolution/layer_fade.hpp"
#include "kernels/reuse/resolution_planner.hpp"

namespace inverse {

/// IntrinsicDecomposition at the frame's resolution or, for less time, on a frame that is halved
/// once or twice, with guided upsampling of shading. A change of resolution continues from what the
/// one before found: that frame is solved at both, and the output fades from one to the other. Each
/// resolution is set up when it is first needed, or by `prepare`. Not thread-safe.
class ScaledIntrinsic {
 public:
  struct Params : IntrinsicDecomposition::Params {
    bool half_resolution = false;
    /// With half_resolution: a quarter of width and height instead.
    bool quarter_resolution = false;
    /// How often the frame is halved before it is solved, unless Tolerances::half decides.
    size_t halvings() const { return !half_resolution ? 0 : quarter_resolution ? 2 : 1; }
    void set_halvings(size_t halvings) {
      half_resolution = halvings > 0;
      quarter_resolution = halvings > 1;
    }
    bool operator==(const Params&) const = default;
  };
  using FrameInfo = IntrinsicDecomposition::FrameInfo;
  struct Stats : IntrinsicDecomposition::Stats {
    SceneLight::Params light;
    size_t halvings = 0;
    bool crossed = false;   ///< solved at the last frame's resolution, too, to continue from it
    bool compared = false;  ///< solved at the other resolution, too, to measure their distance
  };
  struct Findings : IntrinsicDecomposition::Findings {
    float half_distance = 0;  ///< of half from full resolution when last compared; 0: not yet
  };

  /// Makes the kernels of all resolutions, whose buffers follow when they are first needed.
  ScaledIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent);

  /// How often frames of this size have to be halved so that kernels can bind all planes of a
  /// solve. Throws Error(limit) with the largest size if they would have to be more often than
  /// twice.
  static size_t min_halvings(const gpu::Device& device, Extent extent);
  /// Sets a resolution up for good, with a network of the prior or, null, without. Throws
  /// Error(limit) if frames of this size do not fit the device.
  void prepare(size_t halvings, const PriorModelPtr& network = nullptr) {
    halvings = std::max(halvings, min_halvings_);
    set_up(halvings);
    methods_[halvings]->prepare(network);
    if (network) IntrinsicDecomposition(device_, kTiny).prepare(network);
    stays_[halvings] = true;
  }
  /// As IntrinsicDecomposition::record.
  Layers record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                const FrameInfo& info);
  /// Whether another run on the picture of `frame`, one of the last kFramesInFlight that is done,
  /// would change little: its last cycle did, no layers fade, and no stroke is filled.
  bool converged(uint64_t frame, const Params& params) const {
    return !fade_.on() && !methods_[was_]->fills() &&
           findings(frame).change < params.tolerances.repeat;
  }
  /// Forgets the frames so far (flush, discontinuity).
  void reset();
  uint64_t recorded() const { return recorded_; }
  /// Of one of the last kFramesInFlight frames.
  const Stats& stats(uint64_t frame) const { return past(frame).stats; }
  /// Of one of the last kFramesInFlight frames, once its Commands have been waited for.
  Findings findings(uint64_t frame) const;

 private:
  static constexpr size_t kResolutions = 3;
  /// For kernels, which do not depend on the size and stay with the device.
  static constexpr Extent kTiny{1, 1};
  /// From one resolution down to the next coarser one, and up again.
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
  /// One of the last frames.
  struct Past {
    Stats stats;
    uint64_t number = 0;  // of its resolution's method
    float half_distance = 0;
  };
  const Past& past(uint64_t frame) const { return past_[frame]; }
  IntrinsicDecomposition& method(size_t halvings) { return *methods_[halvings]; }
  void set_up(size_t halvings);
  /// Of the last frame that is sure to be done; empty if there is none.
  std::optional<ResolutionPlanner::Found> found_before() const;
  /// Half resolution is set up again when it is next used.
  void release_half();
  void restart();
  /// The frame's intrinsic plane and slope, solved after `halvings`.
  struct Solved {
    PlanePtr intrinsic, slope;
  };
  Solved solve(gpu::Commands& commands, size_t halvings, const PlanePtr& input,
               const Params& params, const FrameInfo& info);
  void warm_start(gpu::Commands& commands, size_t from, size_t to, PlanePtr intrinsic);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  std::array<std::optional<IntrinsicDecomposition>, kResolutions> methods_;
  std::array<std::optional<Step>, kResolutions - 1> steps_;  // [k] from k halvings to k + 1
  std::array<bool, kResolutions> stays_{};                   // set up for good
  std::optional<SceneLight> light_;
  std::optional<LayerDistance> distance_;
  LayerFade fade_;
  ResolutionPlanner planner_;
  gpu::FrameRing<Past> past_;
  uint64_t recorded_ = 0;
  StrokesPtr strokes_;  // of the frame before
  bool first_ = true;   // no frame is before the next one
  size_t was_ = 0;      // halvings of the frame before
  size_t min_halvings_;
};

}  // namespace inverse
