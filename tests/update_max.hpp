// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <cmath>
#include <type_traits>

namespace inverse {

/// Raises `max` to `value`. Once NaN, it stays NaN, and fails every comparison; std::max(max, NaN)
/// is max.
template <typename T>
void update_max(T& max, const std::type_identity_t<T>& value) {
  if (std::isnan(value) || value > max) max = value;
}

}  // namespace inverse
