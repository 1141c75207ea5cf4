#pragma once
#include <array>
#include <memory>

#include "../intrinsic/intrinsic_decomposition.hpp"
#include "light_model.hpp"

namespace inverse {

/// Reflectance, white direct light and colored indirect light of every frame of a video: the color
/// of the light comes from LightModel, its brightness from IntrinsicDecomposition of the frame
/// without that color (docs/method-globalintrinsic.md). Owns the kernels and the temporal state for
/// one size on one device. Not thread-safe.
class GlobalIntrinsic {
 public:
  struct Params {
    IntrinsicDecomposition::Params solve;
    LightModel::Params light;
    bool operator==(const Params&) const = default;
  };
  using FrameInfo = IntrinsicDecomposition::FrameInfo;

  /// What a frame is made of: frame = reflectance.rgb (light.rgb + light.w).
  struct Result {
    PlanePtr reflectance;  ///< R.rgb, mean of the light
    PlanePtr light;        ///< indirect light E.rgb, direct light T0
    PlanePtr tints;        ///< log chroma of the light (x, y), base color (z)
  };

  /// What the device found out about the last frame, once its Commands have been waited for.
  struct Findings {
    float amount = 0;      ///< of indirect light
    float confidence = 0;  ///< in it, 0…1
    float tint = 0;        ///< rms log chroma of light that is all indirect
    bool cut = false;      ///< a first frame, or nothing was taken over
    uint32_t colors = 0;   ///< base colors in use
    std::array<std::array<float, 2>, LightModel::kSlots> base{};  ///< their log chroma
    std::array<bool, LightModel::kSlots> used{};
  };

  /// Throws Error(limit) where frames of this size do not fit the device.
  GlobalIntrinsic(std::shared_ptr<gpu::Device> device, Extent extent);

  /// Records the decomposition of `input` (linear RGB; w = alpha).
  Result record(gpu::Commands& commands, const PlanePtr& input, const Params& params,
                const FrameInfo& info);
  Findings findings() const;
  const IntrinsicDecomposition& solver() const { return solver_; }
  const LightModel& light() const { return light_; }

 private:
  std::shared_ptr<gpu::Device> device_;
  PlanePool planes_;
  LightModel light_;
  IntrinsicDecomposition solver_;
  gpu::BufferPtr found_;  // scene, base
  bool history_ = false;
};

}  // namespace inverse
