// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <vector>

#include "stroke.hpp"

namespace inverse {

/// Where the surroundings of a stroke are compared to follow it: on a regular grid over the stroke
/// and a margin of a quarter of its
/// radius, at least 8 pixels.
struct StrokeSamples {
  static constexpr uint32_t kMax = 1024, kMaxLevel = 5;
  Stroke::Point center{};  ///< their mean, in pixels of the frame
  float radius = 1;        ///< rms distance from it, at least 1
  /// The coarsest pyramid level on which they are still some pixels across.
  uint32_t levels = 0;
  std::vector<std::array<float, 4>> samples;  ///< x and y from the center, weight, 0
};

/// Of a stroke on a frame of size `frame`, in pixels of `extent`. At most kMax, none outside of the
/// frame.
StrokeSamples samples_of(const Stroke& stroke, Extent frame, Extent extent);

}  // namespace inverse
