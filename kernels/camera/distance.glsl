// SPDX-License-Identifier: LGPL-2.1-or-later
// distance_at(): the signed distance between voxels. Needs find_block.glsl, voxel.glsl, and WORD_IN `voxels`.
const float kMinSeen = 0.33;

// The places of the eight voxels from `voxel` on, or kNoBlock. Only blocks that they lie in are looked up: one in most cases.
uint[8] corners(ivec3 voxel) {
  ivec3 first = block_of(voxel), across = block_of(voxel + 1) - first;
  uint axes = uint(across.x | across.y << 1 | across.z << 2), part = 0u;  // bits of axes
  uint places[8] = uint[](kNoBlock, kNoBlock, kNoBlock, kNoBlock, kNoBlock, kNoBlock, kNoBlock, kNoBlock);
  do {
    uint block = find_block(first + ivec3(part & 1u, part >> 1 & 1u, part >> 2));
    for (uint n = 0u; n < 8u; ++n) {
      uint place = block * kBlockVoxels + place_in_block(voxel + ivec3(n & 1u, n >> 1 & 1u, n >> 2));
      places[n] = (n & axes) == part && block != kNoBlock ? place : places[n];
    }
    part = (part - axes) & axes;  // the next subset of the axes
  } while (part != 0u);
  return places;
}
float corner_weight(vec3 share, uint n) {
  vec3 w = mix(1.0 - share, share, vec3(n & 1u, n >> 1 & 1u, n >> 2));
  return w.x * w.y * w.z;
}

// Interpolated distance of the voxels that were seen, in units of the truncation; 2 if they are less than a third.
float distance_at(vec3 at) {
  ivec3 voxel = ivec3(floor(at - 0.5));
  vec3 share = at - 0.5 - vec3(voxel);
  uint places[8] = corners(voxel);
  float sum = 0.0, total = 0.0;
  for (uint n = 0u; n < 8u; ++n) {
    Voxel v = voxel_of(places[n] == kNoBlock ? 0u : FETCH1(voxels, int(places[n])));
    float weight = v.weight > 0.0 ? corner_weight(share, n) : 0.0;
    sum += weight * v.distance;
    total += weight;
  }
  return total >= kMinSeen ? sum / total : 2.0;
}

// The unit normal of the surface near a place, out of it: differences of the distance `reach` voxels to both sides along the axes. 0
// where one of them is not known.
vec3 normal_at(vec3 at, float reach) {
  vec3 slope = vec3(0.0);
  for (int c = 0; c < 3; ++c) {
    vec3 off = vec3(0.0);
    off[c] = reach;
    float low = distance_at(at - off), high = distance_at(at + off);
    if (max(low, high) > 1.0) return vec3(0.0);
    slope[c] = high - low;
  }
  float square = dot(slope, slope);
  return square > 0.0 ? slope * inversesqrt(square) : vec3(0.0);
}
