// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mosaic.hpp"

#include <algorithm>

namespace inverse::reference {

Plane mosaic(const std::array<Tile, 4>& tiles, int width, int height) {
  Plane target(width, height);
  const int left = (width + 1) / 2, top = (height + 1) / 2;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool right = x >= left, bottom = y >= top;
      const Tile& tile = tiles[(bottom ? 2 : 0) + (right ? 1 : 0)];
      Vec4& pixel = target.at(x, y);
      pixel = {0, 0, 0, 1};
      if (!tile.picture) continue;
      const int u = 2 * (right ? x - left : x), v = 2 * (bottom ? y - top : y);
      for (const int j : {v, std::min(v + 1, height - 1)})
        for (const int i : {u, std::min(u + 1, width - 1)})
          for (std::size_t c = 0; c < 3; ++c)
            pixel[c] += tile.gain / 4 * tile.picture->at(i, j)[tile.scalar ? 3 : c];
    }
  return target;
}

}  // namespace inverse::reference
