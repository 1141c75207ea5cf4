// SPDX-License-Identifier: LGPL-2.1-or-later
// lit_share(): how much of a lamp is seen from a place, by a march through the volume. Needs what distance.glsl needs, and
// push.voxel and push.truncation.
#include "camera/distance.glsl"

const uint kMaxShadowSteps = 512u;
const float kMinHalfWidth = 1.0;  // voxels: half of the width over which the edge of a shadow falls, at least
const float kFarVoxels = 1e6;     // of the world's origin: beyond, no block has a key and floats are coarse

// Of a ray from `from` in the unit direction `way`, both in voxels, of length `reach`. A ray is free by 1/2 + d / 2 w of its light
// where the distance to a surface is d and the lamp's disk, seen from `from`, is 2 w wide: w is `spread` times the way there. What
// was never seen is free.
float lit_share(vec3 from, vec3 way, float reach, float spread) {
  float share = 1.0, truncation = push.truncation / push.voxel;
  ivec3 block_at = kBlockMin - 1;
  uint block = kNoBlock;
  float t = 0.0;
  for (uint i = 0u; i < kMaxShadowSteps && t < reach; ++i) {
    vec3 at = from + t * way;
    if (any(greaterThan(abs(at), vec3(kFarVoxels)))) break;
    ivec3 voxel = ivec3(floor(at));
    if (block_of(voxel) != block_at) {
      block_at = block_of(voxel);
      block = find_block(block_at);
    }
    if (block == kNoBlock) {
      t += way_out(at, way, block_at) + 0.05;
      continue;
    }
    Voxel v = voxel_of(FETCH1(voxels, int(block * kBlockVoxels + place_in_block(voxel))));
    float step_t = 1.0;
    if (v.weight > 0.0) {
      float half_width = clamp(spread * t, kMinHalfWidth, truncation), off = v.distance * truncation;
      // The voxel's center is up to .87 voxels away, and its distance may be too large by some.
      if (off < half_width + 1.2) {
        float between = distance_at(at);
        off = between > 1.0 ? off : between * truncation;
        share = min(share, 0.5 + 0.5 * off / half_width);
        if (share <= 0.0) return 0.0;
      }
      step_t = max(0.7 * off, 0.5);
    }
    t += step_t;
  }
  return share;
}
