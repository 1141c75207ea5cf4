// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <memory>

#include "kernels/image/plane.hpp"

namespace inverse {

/// A picture that uses all branches: tiles of many colors, or of grays, under a light that falls
/// off. Linear, 0…1.
PlanePtr warm_up_picture(const std::shared_ptr<gpu::Device>& device, Extent extent,
                         bool gray = false);

/// Large enough for every kind of multigrid level at full resolution.
inline constexpr Extent kWarmUpExtent{192, 144};

}  // namespace inverse
