// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <span>
#include <vector>

#include "prefiltered_light.hpp"

namespace inverse {

/// A part of the light that comes from about one direction, in the axes of its map.
struct LightBeam {
  std::array<float, 3> mean{};  ///< mean direction by flux, not normalized: shorter the wider it is
  float flux = 0;               ///< ∫ E dw, mean of the channels
  bool operator==(const LightBeam&) const = default;
};

struct LightBeams {
  static constexpr size_t kMaxLamps = 8;  ///< further ones count as surroundings
  std::vector<LightBeam> beams;           ///< all light, at most 16 parts; the lamps first
  size_t lamps = 0;                       ///< of these, which are brighter than their surroundings
};

/// Divides light for shadows: lamps, around the brightest cells of more than three times the mean
/// radiance, 25 degrees in radius; and the rest by octants. `cells` as PrefilteredLight::cells.
LightBeams divided_light(std::span<const PrefilteredLight::Vec4> cells);

}  // namespace inverse
