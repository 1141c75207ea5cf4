#pragma once
#include <cstdint>

#include "global_intrinsic.hpp"
#include "kernels/image/quads.hpp"

namespace inverse {

/// What the parts of GlobalIntrinsic share with each other and with model.glsl.
namespace global_model {

inline constexpr uint32_t kSlots = 16, kBinCount = 64 * 64, kCandidates = 16, kSceneAmount = 0,
                          kSceneTint = 1, kSceneTime = 2, kSceneColors = 8, kSceneSize = 40;
inline constexpr uint64_t kUsable = 16 * kSceneTint + 8;  // bytes into the scene's buffer
/// How residuals of chroma are believed (residual.glsl).
inline constexpr float kTrust = 0.35F, kTrustTint = 0.7F;

}  // namespace global_model

struct GlobalIntrinsic::Place {
  uint32_t size[2], grid[2], coarse[2], factor;
};

}  // namespace inverse
