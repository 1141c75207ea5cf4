// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cmath>
#include <cstddef>

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

}  // namespace inverse
