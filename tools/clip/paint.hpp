// SPDX-License-Identifier: LGPL-2.1-or-later
// Procedural reflectance: what is painted on the things in the scene.
#pragma once

#include "vec.hpp"

namespace inverse::clip {

enum class Pattern {
  kPlain,      ///< colors[0]
  kChecker,    ///< squares of `period` in colors[0..2], on the local xz plane
  kStripes,    ///< bands along y of height `period`: colors[0], colors[1]
  kSegments,   ///< gores of a ball about y, with white caps
  kWood,       ///< planks along x of width `period`, grain between colors[0] and colors[1]
  kWallpaper,  ///< wide stripes of colors[0], colors[1] with a small printed motif, local xz
  kPoster,     ///< printed sheet, 0.42 m × 0.52 m, local xz
  kBook,       ///< cover colors[0], pages colors[1], title on the spine (local +z)
  kStickers,   ///< 3 × 3 colored squares with black gaps on each face of a cube of edge `period`
  kLeaf,       ///< green with a lighter midrib along x, blade length 2 · `period`
  kSpeckles,   ///< colors[0] with grains of colors[1] and colors[2] of about `period`
};

struct Paint {
  Pattern pattern = Pattern::kPlain;
  Vec3 colors[3];
  float period = 1;
  const char* title = "";
};

/// Linear RGB reflectance in 0…1 at the local position (meters) with the local normal.
Vec3 reflectance(const Paint& paint, Vec3 position, Vec3 normal);

/// Linear color of an 8-bit sRGB triple written 0xRRGGBB.
Vec3 srgb(unsigned code);

}  // namespace inverse::clip
