// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/blocks.glsl"
#include "camera/camera.glsl"
#include "camera/voxel.glsl"

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
WORD_INOUT(8, colored);  // of a block: voxels that have one
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

const float kNear = 0.35;         // truncations from the surface, within which voxels take its color
const float kMinCosine = 0.15;    // of the angle between ray and normal, below which nothing is certain

struct Sample {
  int pixel;
  float distance;  // truncations, to the plane through the seen point; without a normal, along the optical axis
  float cosine, confidence;
  bool known;
};
Sample sample_at(vec3 at) {
  ivec2 pixel = ivec2(floor(projected(push.lens, at) + 0.5));
  bool inside = at.z > 0.0 && all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(push.size)));
  int from = inside ? pixel.y * int(push.size.x) + pixel.x : 0;
  vec3 normal = FETCH(surface, from).xyz;
  float z = FETCH1(depth, from), facing = -dot(normal, at), cosine = facing * inversesqrt(dot(at, at));
  float distance = (z - at.z) * (cosine > kMinCosine ? facing / at.z : 1.0) / push.truncation;
  float confidence = clamp(cosine, kMinCosine, 1.0) * clamp(1.0 / (z * z), 0.125, 1.0);
  return Sample(from, distance, cosine, confidence, inside && z > 0.0 && z <= push.max_depth && distance >= -1.0);
}

void main() {
  uint entry = FETCH1(list, int(gl_WorkGroupID.x)), block = entry & 0x7fffffffu;
  bool empty = entry != block;
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1);
  ivec3 first = kBlockSide * block_of_key(FETCH1(keys, int(block))) + ivec3(gl_LocalInvocationID.x & 7u, gl_LocalInvocationID.x >> 3, 0);
  vec3 at = to_camera(rotation, place, (vec3(first) + 0.5) * push.voxel);
  vec3 along = turned(vec4(-rotation.xyz, rotation.w), vec3(0.0, 0.0, push.voxel));
  uint first_index = block * kBlockVoxels + gl_LocalInvocationID.x;
  uint near_surface = 0u, first_colors = 0u;  // a bit a voxel; voxels
  for (int k = 0; k < kBlockSide; ++k) {
    Sample s = sample_at(at + float(k) * along);
    bool measured = s.known && push.geometry != 0u;
    Voxel v = voxel_of(empty ? 0u : LOAD(voxels, first_index + 64u * uint(k)));
    float weight = measured ? max(floor(kWeightSteps * s.confidence + 0.5), 1.0) : 0.0;
    v.distance = (v.distance * v.weight + min(s.distance, 1.0) * weight) / max(v.weight + weight, 1.0);
    v.weight = min(v.weight + weight, 255.0);
    if (empty || measured) STORE(voxels, first_index + 64u * uint(k), word_of(v));
    bool near = s.known && push.reflectance != 0u && s.cosine > kMinCosine && abs(s.distance) < kNear;
    near_surface |= uint(near) << k;
  }
  // Few voxels of a column have a color to take.
  for (uint left = empty ? 255u : near_surface; left != 0u; left &= left - 1u) {
    uint k = uint(findLSB(left)), index = color_index(block, gl_LocalInvocationID.x + 64u * k);
    Sample s = sample_at(at + float(k) * along);
    vec4 mean = empty ? vec4(0.0) : reflectance_of(uvec2(LOAD(colors, index), LOAD(colors, index + kBlockVoxels)));
    vec3 now = log(max(FETCH(layers, s.pixel).rgb, vec3(1e-3)));
    float before = mean.w * push.memory, added = (near_surface >> k & 1u) != 0u ? s.confidence : 0.0;
    mean = vec4(mix(mean.rgb, now, added / max(before + added, 1e-9)), min((before + added) / push.memory, 1.0));
    uvec2 words = words_of(mean);
    STORE(colors, index, words.x);
    STORE(colors, index + kBlockVoxels, words.y);
    first_colors += before == 0.0 && added > 0.0 ? 1u : 0u;
  }
  if (first_colors > 0u) atomicAdd(LOAD(colored, block), first_colors);
}
