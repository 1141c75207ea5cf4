// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <optional>

namespace inverse {

/// Where skin touches a scene.
struct Touch {
  std::array<float, 3> place{};               ///< on its surface, meters
  std::optional<std::array<float, 3>> color;  ///< reflectance there, linear RGB
  float area = 0;                             ///< of skin that is near, weighted, m²
  float distance = 0;                         ///< from there to the scene, mean, meters
};

}  // namespace inverse
