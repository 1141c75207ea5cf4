// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cstdint>

#include "global_intrinsic.hpp"
#include "kernels/image/pack4.hpp"

/// Constants that the parts of GlobalIntrinsic share with each other and with model.glsl.
namespace inverse::global_model {

using Model = shaders::global_scene_weigh;
/// Place in the scene's buffer, bytes.
inline constexpr uint64_t kUsable = sizeof(float) * (4 * Model::SCENE_TINT + Model::TINT_USABLE);
static_assert(Model::kSlots == kMaxBases);
/// Standard deviations of the confidence of a residual of chroma (residual.glsl), log units.
inline constexpr float kResidualSigma = 0.35F, kTintSigma = 0.7F;

}  // namespace inverse::global_model
