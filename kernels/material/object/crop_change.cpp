// SPDX-License-Identifier: LGPL-2.1-or-later
#include "crop_change.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace inverse {

void CropChange::keep(std::span<const float> image, std::span<const uint8_t> mask, uint32_t side) {
  kept_.assign(image.begin(), image.begin() + size_t{4} * side * side);
  kept_mask_.assign(mask.begin(), mask.end());
}

CropChange::Difference CropChange::since(std::span<const float> image,
                                         std::span<const uint8_t> mask, uint32_t side) const {
  if (kept_.size() != size_t{4} * side * side) return {};
  Difference difference;
  uint32_t blocks = 0;
  for (uint32_t top = 0; top < side; top += kBlock)
    for (uint32_t left = 0; left < side; left += kBlock) {
      std::array<float, 3> sum{};
      uint32_t points = 0, all = 0;
      for (uint32_t y = top; y < std::min(top + kBlock, side); ++y)
        for (uint32_t x = left; x < std::min(left + kBlock, side); ++x) {
          const size_t at = size_t{y} * side + x;
          ++all;
          if (!mask.empty() && !mask[at]) continue;
          ++points;
          for (size_t c = 0; c < 3; ++c) sum[c] += image[4 * at + c] - kept_[4 * at + c];
        }
      if (8 * points < all || !points) continue;
      float largest = 0;
      for (const float s : sum) largest = std::max(largest, std::abs(s));
      largest /= static_cast<float>(points);
      difference.largest = std::max(difference.largest, largest);
      difference.mean += largest;
      ++blocks;
    }
  if (blocks) difference.mean /= static_cast<float>(blocks);
  if (mask.size() == kept_mask_.size()) {
    size_t points = 0, other = 0;
    for (size_t i = 0; i < mask.size(); ++i) {
      points += mask[i] != 0;
      other += (mask[i] != 0) != (kept_mask_[i] != 0);
    }
    if (other)
      difference.moved =
          static_cast<float>(other) / static_cast<float>(std::max(points, size_t{1}));
  }
  return difference;
}

}  // namespace inverse
