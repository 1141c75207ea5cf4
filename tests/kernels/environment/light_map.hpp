// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include "kernels/environment/environment.hpp"
#include "tests/reference/environment/lit_sphere.hpp"

namespace inverse::testing {

/// The same for the double-precision reference.
inline reference::LightMap light_map(const Environment& light) {
  reference::LightMap map{static_cast<int>(light.extent().height), {}};
  const auto& rgb = light.rgb();
  for (size_t i = 0; i < rgb.size(); i += 3)
    map.radiance.push_back({rgb[i], rgb[i + 1], rgb[i + 2]});
  return map;
}

}  // namespace inverse::testing
