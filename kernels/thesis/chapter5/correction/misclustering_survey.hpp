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

/// A small frame in which misclustered regions are looked for.
struct Survey {
  Extent extent;
  /// Linear rgb, and cluster + 1 + kClusterCodes · number of the marked region, of each pixel.
  std::span<const float> pixels;
  std::span<const BaseColors::Color> colors;
  /// Slot of the base color that each marked region has been given, by its number; −1: none.
  std::array<int, MarkedRegions::kMaxRegions + 1> given;

  static constexpr int kClusterCodes = shaders::thesis_chapter5_correction_survey::kClusterCodes;
};

/// Connected pixels of one cluster that look like another base color than they have.
struct Misclustered {
  int x, y;       ///< of a pixel in it, far from its border
  int pixels;     ///< of the small frame
  int cluster;    ///< slot that they were taken for
  int color;      ///< slot of the base color that they seem to have
  int region;     ///< number of the marked region that they are in, 0: none
  float score;    ///< how much speaks for it, 0…1
  int component;  ///< its number in SurveyResult::components
};

struct SurveyResult {
  std::vector<Misclustered> found;  ///< the largest first
  /// Number of the connected component of each pixel, from 0; −1 if there is no cluster.
  std::vector<int> components;
};

/// Finds regions that strong inter-reflections have given another cluster than their reflectance
/// has (the thesis leaves this to the user, 5.5.2.1), by what such light does:
///
/// - Somewhere the light changes and the surface does not. There the border to the cluster of its
///   true base color is no border of paint: either chroma changes gradually across it, or it is a
///   shadow's, and the light that is missing behind it, times the reflectance, has the chroma of
///   that base color, as direct light is white.
/// - The region's color is that base color under white light and light of a base color that there
///   is enough of around it: a share of all light of up to kHidden times that base color's share of
///   what the region sees of the frame, by 1/distance².
///
/// A region that neither its borders nor its surroundings explain stays as it is. Takes about a
/// millisecond for 160 × 120 pixels.
SurveyResult find_misclustered(const Survey& survey);

}  // namespace inverse
