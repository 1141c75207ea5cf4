// SPDX-License-Identifier: LGPL-2.1-or-later
// Images for the tests of all methods.
#pragma once
#include <array>
#include <random>

#include "method.hpp"

namespace inverse::extremes {

/// Twelve paints, 0.06…0.96, in patches under a light with a border, and noise.
inline Pixels mosaic(Extent extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  float paints[12][3];
  for (auto& paint : paints)
    for (float& channel : paint) channel = 0.06F + 0.9F * unit(random);
  Pixels pixels(4 * extent.pixels(), 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x)
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * (size_t{y} * extent.width + x) + c] =
            (3 * x + 2 * y > extent.width ? 0.9F : 0.35F) * paints[(x / 13 + y / 9 * 5) % 12][c] *
            (0.97F + 0.06F * unit(random));
  return pixels;
}

/// Paints side by side, from left to right, under light that fades downward, and `noise` of it.
inline Pixels walls(Extent extent, const std::vector<std::array<float, 3>>& paints, float noise,
                    unsigned seed = 1, float light = 0.9F) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  Pixels pixels(4 * extent.pixels(), 1);
  for (uint32_t y = 0; y < extent.height; ++y)
    for (uint32_t x = 0; x < extent.width; ++x)
      for (size_t c = 0; c < 3; ++c)
        pixels[4 * (size_t{y} * extent.width + x) + c] =
            paints[x * paints.size() / extent.width][c] * light *
            (1 - 0.4F * static_cast<float>(y) / static_cast<float>(extent.height)) *
            (1 + noise * unit(random));
  return pixels;
}

}  // namespace inverse::extremes
