// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/camera.glsl"
#include "camera/voxel.glsl"

// Where the ray of every second pixel comes near the surface: from there, march.comp follows the rays around it. One ray an invocation.
WORD_IN(0, table);
WORD_IN(1, voxels);
WORD_IN(2, nearest);
WORD_IN(3, farthest);
PLANE_IN(4, pose);
SCALAR_OUT(5, start);  // meters along the optical axis; kNever: there is no surface
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;  // rays
  uint tiles;  // a row
  uint table_mask;
  float voxel;
  float truncation;
} push;
#include "camera/find_block.glsl"
#include "ray.glsl"

const float kNear = 0.5;  // truncations
const float kNever = 1e30;

void main() {
  uint line = line_index();
  uvec2 at = uvec2(line % push.size.x, line / push.size.x);
  if (at.y >= push.size.y) return;
  int tile = int((at.y >> 2) * push.tiles + (at.x >> 2));
  float z = uintBitsToFloat(FETCH1(nearest, tile)), end = uintBitsToFloat(FETCH1(farthest, tile));
  Ray ray = ray_through(push.lens, vec2(2u * at), FETCH(pose, 0), FETCH(pose, 1));
  float before_z = kNever;  // the last place in front of the surface
  bool before = false;   // whether it was seen in the last step
  for (uint i = 0u; i < kMaxSteps && z < end; ++i) {
    float step;
    Voxel v = voxel_at(ray, z, step);
    bool known = v.weight > 0.0;
    if (known && v.distance < kNear && before) break;
    before = known && v.distance > 0.0;
    before_z = before ? z : before_z;
    z += step;
  }
  STORE(start, line, z < end ? before_z : kNever);
}
