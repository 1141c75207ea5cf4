// SPDX-License-Identifier: LGPL-2.1-or-later
// Voxel hashing (Nießner et al. 2013). Space is a grid of blocks of 8³ voxels, of which only those near surfaces have memory. A hash
// table with linear probing finds the memory of a block: two words an entry, the block's key and its place in the pool.
const int kBlockSide = 8;
const uint kBlockVoxels = 512u;
const uint kNoBlock = 0xffffffffu;  // also the key of an empty entry
const uint kMaxProbes = 64u;
const ivec3 kBlockMin = ivec3(-1024, -512, -1024), kBlockMax = ivec3(1023, 511, 1023);  // blocks that have a key

bool has_key(ivec3 block) {
  // The last block's key is that of an empty entry.
  return all(greaterThanEqual(block, kBlockMin)) && all(lessThanEqual(block, kBlockMax)) && block != kBlockMax;
}
uint key_of(ivec3 block) {
  uvec3 b = uvec3(block - kBlockMin);
  return b.x | b.z << 11 | b.y << 22;
}
ivec3 block_of_key(uint key) { return ivec3(key & 2047u, key >> 22, key >> 11 & 2047u) + kBlockMin; }
uint hash_of(uint key) {
  key = (key ^ key >> 16) * 0x85ebca6bu;
  key = (key ^ key >> 13) * 0xc2b2ae35u;
  return key ^ key >> 16;
}
// Of a voxel, from its grid coordinates.
ivec3 block_of(ivec3 voxel) { return voxel >> 3; }
uint place_in_block(ivec3 voxel) {
  uvec3 v = uvec3(voxel & 7);
  return v.x | v.y << 3 | v.z << 6;
}
// How far along a direction a place is from where it leaves a block; all in voxels.
float way_out(vec3 at, vec3 along, ivec3 block) {
  vec3 ways = (vec3(kBlockSide * (block + ivec3(greaterThan(along, vec3(0.0))))) - at) / along;
  ways = mix(ways, vec3(1e9), equal(along, vec3(0.0)));
  return max(min(ways.x, min(ways.y, ways.z)), 0.0);
}
// Of the first word of a voxel's color; the second one is kBlockVoxels after it.
uint color_index(uint block, uint place) { return 2u * kBlockVoxels * block + place; }
