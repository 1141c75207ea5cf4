// SPDX-License-Identifier: LGPL-2.1-or-later
#include "network_rate.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {

bool NetworkRate::due(std::span<const float> input, uint32_t interval) {
  if (std::ranges::equal(input, input_)) {
    age_ = 0;
    return false;
  }
  if (input.size() == input_.size()) {
    float change = 0;
    for (size_t i = 0; i < input.size(); ++i) change += std::abs(input[i] - input_[i]);
    change /= static_cast<float>(input.size());
    const bool still = change < kStill && interval > 1;
    if (change < kCut && ++age_ < (still ? kStillFactor * interval : interval)) return false;
  }
  input_.assign(input.begin(), input.end());
  age_ = 0;
  ++runs_;
  return true;
}

}  // namespace inverse
