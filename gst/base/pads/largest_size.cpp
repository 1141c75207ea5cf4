// SPDX-License-Identifier: LGPL-2.1-or-later
#include "largest_size.hpp"

#include <algorithm>
#include <cmath>

namespace inverse {
namespace {

constexpr uint32_t kPrecision = 64;

/// `asked` with a longer side of this many pixels; even, as formats with halved chroma need it.
Extent shrunk(Extent asked, uint32_t longer) {
  const auto side = [&](uint32_t pixels) {
    const auto scaled =
        static_cast<uint32_t>(uint64_t{pixels} * longer / std::max(asked.width, asked.height));
    return scaled > 1 ? scaled & ~1U : 1;
  };
  return {side(asked.width), side(asked.height)};
}

}  // namespace

std::optional<Extent> largest_extent(Extent asked, uint64_t pixels,
                                     const std::function<bool(Extent)>& fits) {
  const uint32_t longer = std::max(asked.width, asked.height);
  const double scale = std::sqrt(static_cast<double>(pixels) / static_cast<double>(asked.pixels()));
  uint32_t too_large = longer, good = 0;
  if (scale < 1) {
    const auto first = static_cast<uint32_t>(scale * longer);
    (first > 0 && fits(shrunk(asked, first)) ? good : too_large) = first;
  } else if (fits(asked)) {
    return {};
  }
  while (too_large - good > std::max(1U, good / kPrecision)) {
    const uint32_t middle = good + (too_large - good) / 2;
    (fits(shrunk(asked, middle)) ? good : too_large) = middle;
  }
  if (good == 0) return {};
  return shrunk(asked, good);
}

}  // namespace inverse
