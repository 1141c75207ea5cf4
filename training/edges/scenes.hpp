// SPDX-License-Identifier: LGPL-2.1-or-later
// Procedural scenes with known reflectance and shading, to fit the edge prior on.
//
// Rooms and yards of boxes and balls ray-traced under sun, lamp or dapple with ambient
// occlusion and an approximate bounce; curved painted objects on black with marched shadows.
// In most, direct and fill light differ in color along the blue-yellow axis, either way. Textures
// and palettes cover bright colors of equal value as well as inks, grays and browns that differ in
// value only. Nothing in here is measured from, or modeled after, an evaluation image.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/bench/metrics/image.hpp"

namespace inverse::training {

/// A picture and its truth.
struct Scene {
  bench::Image input;        ///< Linear RGB after an 8-bit sRGB round trip.
  bench::Image reflectance;  ///< RGB.
  bench::Image shading;      ///< RGB: irradiance.
  bench::Image mask;         ///< 1 if surfaces are.
};

/// The scene of one seed, width x height pixels.
Scene make_scene(std::uint32_t seed, int width, int height);

}  // namespace inverse::training
