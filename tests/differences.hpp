// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "update_max.hpp"

namespace inverse {

/// The largest |a[i] − b[i]|, or NaN.
template <typename Numbers>
double max_difference(const Numbers& a, const Numbers& b) {
  double max = 0;
  for (std::size_t i = 0; i < a.size(); ++i) update_max(max, std::abs(a[i] - b[i]));
  return max;
}

/// The root mean square of a[i] − b[i].
template <typename Numbers>
double rms_difference(const Numbers& a, const Numbers& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// Log shading up to its scale, which the energy of intrinsicdecomp leaves free.
inline std::vector<double> without_mean(std::vector<double> values) {
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& v : values) v -= mean;
  return values;
}

}  // namespace inverse
