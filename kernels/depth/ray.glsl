// SPDX-License-Identifier: LGPL-2.1-or-later
// Steps along a camera's ray through the volume. Needs find_block.glsl, voxel.glsl, camera.glsl, WORD_IN `voxels`, and push.voxel and
// push.truncation.
const uint kMaxSteps = 512u;

struct Ray {
  vec3 origin, along;      // in voxels; along: for one meter of depth
  float voxel, truncation; // as depths
  ivec3 block_at;          // of the last step
  uint block;
};

Ray ray_through(vec4 lens, vec2 pixel, vec4 rotation, vec4 place) {
  vec3 ray = ray_of(lens, pixel);
  float scale = 1.0 / length(ray);
  return Ray(place.xyz / push.voxel, turned(rotation, ray) / push.voxel, push.voxel * scale, push.truncation * scale, kBlockMin - 1,
             kNoBlock);
}

// The voxel at depth z, and in `step` the depth to the next one that may tell more. Weight 0: nothing is known there.
Voxel voxel_at(inout Ray ray, float z, out float step) {
  vec3 at = ray.origin + z * ray.along;
  ivec3 voxel = ivec3(floor(at)), block_at = block_of(voxel);
  if (block_at != ray.block_at) {
    ray.block_at = block_at;
    ray.block = find_block(block_at);
  }
  float past = way_out(at, ray.along, block_at) + 0.05 * ray.voxel;
  bool none = ray.block == kNoBlock;
  Voxel v = voxel_of(none ? 0u : FETCH1(voxels, int(ray.block * kBlockVoxels + place_in_block(voxel))));
  bool free = v.weight > 0.0 && v.distance > 0.0;
  step = none ? past : free ? max(0.7 * v.distance * ray.truncation, 0.5 * ray.voxel) : ray.voxel;
  return v;
}
