// The scale in which intrinsicdecomp's layers go out, R c and S / c, in double precision. This is
// the specification of kernels/intrinsic/output/output_gauge, which counts in bins of 1/32 where
// this sorts.
#pragma once

#include <vector>

#include "intrinsic_features.hpp"

namespace inverse::reference {

/// Names and defaults are those of kernels/intrinsic.
struct GaugeParams {
  double quantile = 0.98;
  double value = 0.9;
  double share = 0.1;
};

inline constexpr double kGaugeReach = 8;  ///< ln max_c R counts from −8 to 8.
inline constexpr double kDarkest = -3.9;  ///< ln max_c I of a cell that still has a say.

class OutputGauge {
 public:
  explicit OutputGauge(const GaugeParams& params) : params_(params) {}

  /// ln c of a frame with this guide and log shading (of its pixels): what brings the mean of
  /// ln max_c R around its quantile over the cells to the value, mixed by `share` with that of the
  /// frame before where this one `carries` on. Where every cell is dark, that of the frame before,
  /// or 0.
  double update(const Guide& guide, const std::vector<double>& log_shading, bool carries);

 private:
  GaugeParams params_;
  double gauge_ = 0;
  bool known_ = false;
};

}  // namespace inverse::reference
