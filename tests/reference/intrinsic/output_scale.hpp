// SPDX-License-Identifier: LGPL-2.1-or-later
// Scale of intrinsicdecomp's output layers, R c and S / c, in double precision. The specification
// of kernels/intrinsic/output/output_scale, which counts in bins of 1/32 instead of sorting.
#pragma once

#include <optional>
#include <vector>

#include "intrinsic_features.hpp"
#include "tests/reference/solve/scale_normalization.hpp"

namespace inverse::reference {

/// Names and defaults are those of kernels/intrinsic.
struct ScaleParams {
  double quantile = 0.98;
  double white_level = 0.9;
};

inline constexpr double kBrightnessReach = 8;  ///< ln max_c R counts from −8 to 8.
inline constexpr double kDarkest = -3.9;       ///< ln max_c I of a cell that still counts.

class OutputScale {
 public:
  explicit OutputScale(const ScaleParams& params) : params_(params) {}

  /// ln c of a frame with this guide and log shading (of its pixels). Alone, a frame asks for what
  /// brings the mean of ln max_c R around its quantile over the cells to the white level.
  /// White light is that of the brightest cells, weighted by exp(8 (m - light.reference)) up to 1.
  double update(const Guide& guide, const std::vector<double>& log_shading, bool carries,
                const LightColor& light = {});
  /// Log shading of white light in the output, as ScaleNormalization::white.
  double white() const { return normalization_ ? normalization_->white() : 0; }
  /// ln c less ln(white level) that the last frame asks for.
  const ScaleNormalization::ScaleTarget& target() const { return target_; }

 private:
  ScaleParams params_;
  ScaleNormalization::ScaleTarget target_;
  std::optional<ScaleNormalization> normalization_;
};

}  // namespace inverse::reference
