// SPDX-License-Identifier: LGPL-2.1-or-later
// What the measures share.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "image.hpp"

namespace inverse::bench::detail {

constexpr double kMinEnergy = 1e-12;
constexpr double kLogFloor = 1e-4;

inline bool counts(const Image& mask, int x, int y) { return mask.empty() || mask.at(x, y) > 0.5F; }

inline void check_sizes(const Image& a, const Image& b, const Image& mask) {
  const auto size = [](const Image& i) {
    return std::to_string(i.width) + "x" + std::to_string(i.height) + "x" +
           std::to_string(i.channels);
  };
  if (a.width != b.width || a.height != b.height || a.channels != b.channels)
    throw std::invalid_argument("images differ in size: " + size(a) + " and " + size(b));
  if (!mask.empty() && (mask.width != a.width || mask.height != a.height || mask.channels != 1))
    throw std::invalid_argument("a mask of " + size(mask) + " for an image of " + size(a));
}

/// Logarithm of a pixel's mean channel.
inline double log_mean_channel(const Image& image, int x, int y) {
  double sum = 0;
  for (int c = 0; c < image.channels; ++c) sum += image.at(x, y, c);
  return std::log(std::max(sum / image.channels, kLogFloor));
}

}  // namespace inverse::bench::detail
