// SPDX-License-Identifier: LGPL-2.1-or-later
// Input of intrinsicdecomp's edge prior: a guide pyramid and its cues. Double precision;
// docs/reference/methods/intrinsicdecomp.md has the same equations.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tests/reference/image/light_color.hpp"

namespace inverse::reference {

/// One level of the guide: box means of the finest level's log intensity m, log chroma (c0, c1) and
/// value excess u = max_c i - m, and of its gradient activity (gm, gc). In colored light (c0, c1)
/// and max_c i are of the frame in white light.
struct GuideLevel {
  int width = 0, height = 0;
  std::vector<double> m, c0, c1, u, gm, gc;
  std::size_t index(int x, int y) const;  ///< Clamped to the level.
};

inline constexpr int kGuideLevels = 5;
inline constexpr int kCellLevel = 2;  ///< Cells of 4 x 4 pixels carry every term but the edges.
inline constexpr int kFrameStatistics = 5;
inline constexpr int kEdgeFeatures = 15 + kFrameStatistics;  ///< The last are the frame's.
inline constexpr int kCellFeatures = 7 + kFrameStatistics;   ///< The last are the frame's.

struct Guide {
  std::array<GuideLevel, kGuideLevels> level;
  double mean = 0;  ///< Brightness-weighted frame mean of m.
  /// What kind of frame this is, each scaled to about [-2, 2]: (0) ln of the mean step of max_c i
  /// across chroma edges, small on palettes of constant value; (1) the share of chroma edges that
  /// max_c i hardly notices; (2) mean value excess, a saturation; (3) ln of the mean step of m
  /// where chroma is even; (4) the size of the slope of light's color, at most 1.
  std::array<double, kFrameStatistics> statistics{};
};

/// Sanitizes an input value: NaN and negative values become 0; at most 1e4.
double sanitize_linear(double v);

inline constexpr double kIntensityFloor = 2e-3;  ///< Added to light before its logarithm is taken.

/// A pixel as it were in white light: I_c divided by the color that light of brightness m has,
/// m = mean_c ln(I_c + kIntensityFloor).
std::array<double, 3> in_white_light(const std::array<double, 3>& rgb, const LightColor& light);

/// Builds the guide of an interleaved linear RGB image in white light (3 x width x height values,
/// any finite or non-finite value; see sanitize_linear).
Guide make_guide(const double* rgb, int width, int height, const LightColor& light = {});

/// The next coarser level of a guide.
GuideLevel halve(const GuideLevel& fine);

/// Cues of the edge between pixel (x, y) and its right (down = false) or lower neighbor.
void edge_features(const Guide& guide, int x, int y, bool down, double* out);

/// Cues of one cell of level kCellLevel.
void cell_features(const Guide& guide, int x, int y, double* out);

}  // namespace inverse::reference
