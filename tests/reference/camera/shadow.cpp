// SPDX-License-Identifier: LGPL-2.1-or-later
#include "shadow.hpp"

#include <algorithm>
#include <cmath>

namespace inverse::reference {

double lit_share(const Volume& volume, const Vec3& from, const Vec3& way, double reach,
                 double spread) {
  double share = 1;
  const double step = 0.1 * volume.voxel;
  for (int n = 0; n * step < reach; ++n) {
    const double t = n * step;
    Vec3 at;
    Cell cell;
    for (size_t c = 0; c < 3; ++c) {
      at[c] = from[c] + t * way[c];
      cell[c] = int(std::floor(at[c] / volume.voxel));
    }
    const Voxel* voxel = volume.at(cell);
    double distance = 0;
    if (!voxel || voxel->weight <= 0 || !volume.distance_at(at, distance)) continue;
    const double half_width = std::clamp(spread * t, volume.voxel, volume.truncation);
    share = std::min(share, 0.5 + 0.5 * distance * volume.truncation / half_width);
  }
  return std::max(share, 0.0);
}

}  // namespace inverse::reference
