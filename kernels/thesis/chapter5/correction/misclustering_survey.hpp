// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/image/plane.hpp"
#include "kernels/thesis/chapter5/colors/base_colors.hpp"
#include "kernels/thesis/chapter5/regions/marked_regions.hpp"
#include "kernels/thesis_chapter5_correction_survey.spv.hpp"

namespace inverse {

/// A small frame to search for misclustered regions.
struct Survey {
  Extent extent;
  /// Linear rgb, and cluster + 1 + kClusterCodes · number of the marked region, of each pixel.
  std::span<const float> pixels;
  std::span<const BaseColors::Color> colors;
  /// Slot of the base color given to each marked region, by its number; −1: none.
  std::array<int, MarkedRegions::kMaxRegions + 1> given;

  static constexpr int kClusterCodes = shaders::thesis_chapter5_correction_survey::kClusterCodes;
};

/// Connected pixels of one cluster that seem to have another base color.
struct Misclustered {
  int x, y;       ///< of a pixel in it, far from its border
  int pixels;     ///< of the small frame
  int cluster;    ///< slot that they were assigned to
  int color;      ///< slot of the base color that they seem to have
  int region;     ///< number of the marked region that they are in, 0: none
  float score;    ///< 0…1, 1 is certain
  int component;  ///< its number in SurveyResult::components
};

struct SurveyResult {
  std::vector<Misclustered> found;  ///< the largest first
  /// Number of the connected component of each pixel, from 0; −1 if there is no cluster.
  std::vector<int> components;
};

/// Finds regions that were assigned to a wrong cluster because of strong inter-reflections. (The
/// thesis leaves this to the user, 5.5.2.1.) A region is reported if both hold:
///
/// - Its border to the cluster of the reported base color is mostly not a change of paint: chroma
///   changes gradually across it; or it is the border of a shadow, where the missing light times
///   the reflectance has the chroma of that base color, as direct light is white.
/// - Its color is the reported base color under a mixture of white light and light of one base
///   color. The share of the latter is at most kHidden times that base color's share of the light
///   that the region receives from the rest of the frame, weighted by 1/distance².
///
/// Takes about a millisecond for 160 × 120 pixels.
SurveyResult find_misclustered(const Survey& survey);

}  // namespace inverse
