// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace inverse::reference {

/// Mean of the up to four fine pixels under each coarse pixel; `channels` interleaved numbers a
/// pixel.
inline std::vector<double> halve(const std::vector<double>& fine, uint32_t width, uint32_t height,
                                 uint32_t channels) {
  const uint32_t w = (width + 1) / 2, h = (height + 1) / 2;
  std::vector<double> coarse(static_cast<size_t>(w) * h * channels);
  for (uint32_t y = 0; y < h; ++y)
    for (uint32_t x = 0; x < w; ++x)
      for (uint32_t c = 0; c < channels; ++c) {
        double sum = 0;
        int n = 0;
        for (uint32_t v = 2 * y; v < std::min(2 * y + 2, height); ++v)
          for (uint32_t u = 2 * x; u < std::min(2 * x + 2, width); ++u, ++n)
            sum += fine[(static_cast<size_t>(v) * width + u) * channels + c];
        coarse[(static_cast<size_t>(y) * w + x) * channels + c] = sum / n;
      }
  return coarse;
}

}  // namespace inverse::reference
