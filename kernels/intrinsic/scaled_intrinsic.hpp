#pragma once
#include <array>
#include <memory>
#include <optional>

#include "../image/pyramid.hpp"
#include "guided_upsample.hpp"
#include "intrinsic_decomposition.hpp"

namespace inverse {

/// IntrinsicDecomposition at the frame's resolution or, at about a third of the cost, at half of it
/// with guided upsampling of shading. Each resolution is set up when it is first asked for:
/// `prepare` does it beforehand. Not thread-safe.
class ScaledIntrinsic {
 public:
  struct Params : IntrinsicDecomposition::Params {
    bool half_resolution = false;
    bool operator==(const Params&) const = default;
  };
  using FrameInfo = IntrinsicDecomposition::FrameInfo;
  struct Stats : IntrinsicDecomposition::Stats {
    bool half_resolution = false;
  };
  using Findings = IntrinsicDecomposition::Findings;

  ScaledIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent)
      : device_(std::move(device)), extent_(extent) {}

  /// Throws Error(limit) where frames of this size do not fit the device.
  void prepare(bool half_resolution);
  /// As IntrinsicDecomposition::record. Where the resolution changes, history begins anew but for
  /// the output's scale.
  Layers record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                const FrameInfo& info);
  /// As IntrinsicDecomposition::drawn; null at half resolution, where every tile is worked on.
  const TileList* drawn() const { return !was_half_ && full_ ? full_->drawn() : nullptr; }
  /// Forgets the frames so far (flush, discontinuity).
  void reset();
  uint64_t recorded() const { return recorded_; }
  /// Of one of the last kFramesInFlight frames.
  Stats stats(uint64_t frame) const;
  /// Of one of the last kFramesInFlight frames, once its Commands have been waited for.
  Findings findings(uint64_t frame) const;

 private:
  struct Half {
    Half(const std::shared_ptr<gpu::Device>& device, Extent extent)
        : halve(device),
          upsample(device, extent),
          inputs(device, half_of(extent)),
          layers(device, extent),
          method(device, half_of(extent)) {}
    Halve halve;
    GuidedUpsample upsample;
    PlanePool inputs, layers;
    IntrinsicDecomposition method;
  };
  /// Which method took a frame, and as its how many-th.
  struct Taken {
    bool half;
    uint64_t number;
  };
  const IntrinsicDecomposition& method(bool half) const { return half ? half_->method : *full_; }
  Layers record_half(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                     const FrameInfo& info);

  std::shared_ptr<gpu::Device> device_;
  Extent extent_;
  std::optional<IntrinsicDecomposition> full_;
  std::optional<Half> half_;
  std::array<Taken, gpu::kFramesInFlight> taken_{};
  uint64_t recorded_ = 0;
  bool was_half_ = false;
};

}  // namespace inverse
