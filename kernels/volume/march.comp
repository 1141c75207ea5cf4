// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera.glsl"
#include "voxel.glsl"

// What a camera sees of the volume: the first place along each ray where the distance turns from positive to negative. One pixel an
// invocation.
WORD_IN(0, table);
WORD_IN(1, voxels);
WORD_IN(2, colors);
WORD_IN(3, nearest);
WORD_IN(4, farthest);
PLANE_IN(5, pose);
SCALAR_OUT(6, depth);       // meters along the optical axis; 0: nothing
PLANE_OUT(7, reflectance);  // rgb: ln reflectance; w: confidence, 0: unknown
WORD_OUT(8, strokes);       // of the nearest voxel
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  uint tiles;  // a row
  uint table_mask;
  float voxel;
  float truncation;
} push;
#include "find_block.glsl"
#include "distance.glsl"

const uint kMaxSteps = 512u;
const int kRefinements = 2;

void main() {
  uint line = line_index();
  uvec2 pixel = uvec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= push.size.y) return;
  uint tile = (pixel.y >> 3) * push.tiles + (pixel.x >> 3);
  float z = uintBitsToFloat(FETCH1(nearest, int(tile))), end = uintBitsToFloat(FETCH1(farthest, int(tile)));
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1);
  vec3 ray = ray_of(push.lens, vec2(pixel));
  float length_of_ray = length(ray);
  vec3 origin = place.xyz / push.voxel, along = turned(rotation, ray) / push.voxel;  // in voxels
  float one = push.voxel / length_of_ray;                                             // depth of a voxel's side
  float truncation = push.truncation / length_of_ray;
  float before = 0.0, behind = 0.0, before_z = z, hit = 0.0;  // distances and depths on both sides of the surface
  ivec3 block_at = kBlockMin - 1;
  uint block = kNoBlock;
  for (uint i = 0u; i < kMaxSteps && z < end; ++i) {
    vec3 at = origin + z * along;
    ivec3 voxel = ivec3(floor(at));
    if (block_of(voxel) != block_at) {
      block_at = block_of(voxel);
      block = find_block(block_at);
    }
    float step_z;
    if (block == kNoBlock) {
      // To where the ray leaves the block.
      vec3 leaves = (vec3(kBlockSide * (block_at + ivec3(greaterThan(along, vec3(0.0))))) - at) / along;
      leaves = mix(leaves, vec3(1e9), equal(along, vec3(0.0)));
      step_z = max(min(leaves.x, min(leaves.y, leaves.z)), 0.0) + 0.05 * one;
      before = 0.0;
    } else {
      Voxel v = voxel_of(FETCH1(voxels, int(block * kBlockVoxels + place_in_block(voxel))));
      if (v.weight > 0.0 && v.distance <= 0.0) {
        if (before > 0.0) {
          hit = z;
          behind = v.distance;
          break;
        }
        step_z = one;  // from behind, or from where nothing is known
      } else {
        step_z = v.weight > 0.0 ? max(0.7 * v.distance * truncation, 0.5 * one) : one;
        before = v.weight > 0.0 ? v.distance : 0.0;
      }
      before_z = v.weight > 0.0 && v.distance > 0.0 ? z : before_z;
    }
    z += step_z;
  }
  // Where the interpolated distance is zero: by secants, from where the line through both voxels is.
  float result = 0.0;
  vec4 color = vec4(0.0);
  uint stroke = 0u;
  if (hit > 0.0) {
    float slope = min((behind - before) / (hit - before_z), -0.2 / truncation);
    result = before_z - before / slope;
    float off = 0.0, last = result;
    for (int i = 0; i < kRefinements; ++i) {
      float now = distance_at(origin + result * along);
      if (abs(now) > 1.0) break;
      float step = result - last, found = (now - off) / step;
      slope = i > 0 && abs(step) > 0.02 * one && found * truncation < -0.1 ? found : slope;
      last = result;
      off = now;
      result -= clamp(now / slope, -one, one);
    }
    vec3 at = origin + result * along;
    ivec3 voxel = ivec3(floor(at - 0.5));
    vec3 share = at - 0.5 - vec3(voxel);
    ivec3 first_at = block_of(voxel);
    uint first = find_block(first_at);
    float total = 0.0, most = 0.0;
    for (uint n = 0u; n < 8u && result > 0.0; ++n) {
      uint index = corner(voxel, n, first, first_at);
      if (index == kNoBlock) continue;
      int word = int(color_index(index / kBlockVoxels, index % kBlockVoxels));
      vec4 c = reflectance_of(uvec2(FETCH1(colors, word), FETCH1(colors, word + int(kBlockVoxels))));
      float weight = corner_weight(share, n), sure = weight * c.w;
      color += vec4(sure * c.rgb, sure);
      total += weight;
      if (weight > most) {
        most = weight;
        stroke = voxel_of(FETCH1(voxels, int(index))).stroke;
      }
    }
    color = color.w > 0.0 ? vec4(color.rgb / color.w, color.w / total) : vec4(0.0);
  }
  uint to = pixel.y * push.size.x + pixel.x;
  STORE(depth, to, result);
  STORE(reflectance, to, color);
  STORE(strokes, to, stroke);
}
