// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "blocks.glsl"
#include "camera.glsl"
#include "voxel.glsl"

// Adds a frame to the listed blocks: distance to the surface along its normal (a weighted mean; Curless and Levoy 1996), and ln
// reflectance near it (an exponential mean, weighted by confidence). A workgroup of 64 a block, a column of 8 voxels an invocation.
WORD_IN(0, list);
WORD_IN(1, keys);
PLANE_IN(2, pose);
PLANE_IN(3, surface);  // of which the normals are used
SCALAR_IN(4, depth);
PLANE_IN(5, layers);   // rgb: reflectance
WORD_INOUT(6, voxels);
WORD_INOUT(7, colors);  // two a voxel
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  float voxel;
  float truncation;
  float max_depth;
  float memory;     // confidences that reflectance remembers
  uint geometry;    // 0: distances stay as they are
  uint reflectance; // 0: colors stay as they are
} push;

const float kNear = 0.5;          // truncations from the surface, within which voxels take its color
const float kMinCosine = 0.15;    // of the angle between ray and normal, below which nothing is certain

void main() {
  uint entry = FETCH1(list, int(gl_WorkGroupID.x)), block = entry & 0x7fffffffu;
  bool empty = entry != block;
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1);
  ivec3 first = kBlockSide * block_of_key(FETCH1(keys, int(block))) + ivec3(gl_LocalInvocationID.x & 7u, gl_LocalInvocationID.x >> 3, 0);
  vec3 at = to_camera(rotation, place, (vec3(first) + 0.5) * push.voxel);
  vec3 along = turned(vec4(-rotation.xyz, rotation.w), vec3(0.0, 0.0, push.voxel));
  uint index = block * kBlockVoxels + gl_LocalInvocationID.x;
  for (int k = 0; k < kBlockSide; ++k, index += 64u, at += along) {
    ivec2 pixel = ivec2(floor(projected(push.lens, at) + 0.5));
    bool inside = at.z > 0.0 && all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(push.size)));
    int from = inside ? pixel.y * int(push.size.x) + pixel.x : 0;
    vec4 seen = vec4(FETCH(surface, from).xyz, FETCH1(depth, from));
    float cosine = -dot(seen.xyz, at) * inversesqrt(dot(at, at));
    // To the plane through the seen point; without a normal, along the optical axis.
    float distance = (seen.w - at.z) * (cosine > kMinCosine ? -dot(seen.xyz, at) / at.z : 1.0) / push.truncation;
    float confidence = clamp(cosine, kMinCosine, 1.0) * clamp(1.0 / (seen.w * seen.w), 0.125, 1.0);
    bool known = inside && seen.w > 0.0 && seen.w <= push.max_depth && distance >= -1.0;
    Voxel v = voxel_of(empty ? 0u : LOAD(voxels, index));
    if (known && push.geometry != 0u) {
      float weight = max(floor(kWeightSteps * confidence + 0.5), 1.0);
      v.distance = (v.distance * v.weight + min(distance, 1.0) * weight) / (v.weight + weight);
      v.weight = min(v.weight + weight, 255.0);
    }
    if (empty || (known && push.geometry != 0u)) STORE(voxels, index, word_of(v));
    bool colored = known && push.reflectance != 0u && cosine > kMinCosine && abs(distance) < kNear;
    if (!empty && !colored) continue;
    vec4 mean = empty ? vec4(0.0) : reflectance_of(uvec2(LOAD(colors, 2u * index), LOAD(colors, 2u * index + 1u)));
    if (colored) {
      vec3 now = log(max(FETCH(layers, from).rgb, vec3(1e-3)));
      float before = mean.w * push.memory;
      mean.rgb = before > 0.0 ? mix(mean.rgb, now, confidence / (before + confidence)) : now;
      mean.w = min((before + confidence) / push.memory, 1.0);
    }
    uvec2 words = words_of(mean);
    STORE(colors, 2u * index, words.x);
    STORE(colors, 2u * index + 1u, words.y);
  }
}
