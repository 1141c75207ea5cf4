// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "edit/edit.glsl"
#include "tone.glsl"

// One workgroup: middle shading, the mean of log2 S where the mask selects, over a sample of the pixels that are lit. It
// follows its measurement over some frames, and jumps with it if that is far away.
layout(constant_id = 1) const bool MATTE = false;
PLANE_IN(0, intrinsic);
PLANE_IN(1, mask);
PLANE_INOUT(2, level);  // one vec4: log2 of middle shading, 1 once it was measured
layout(push_constant) uniform Push {
  uvec2 size;
  uint fresh;  // 1: forget the frames before
} push;

const float kFollow = 0.125;  // share of the way to the measurement, a frame
const float kJump = 1.0;      // stops

void main() {
  vec4 sum = vec4(0.0);
  uvec2 grid = min(push.size, uvec2(kSampleSide));
  for (uint i = gl_LocalInvocationID.x; i < grid.x * grid.y; i += gl_WorkGroupSize.x) {
    uvec2 at = uvec2(i % grid.x, i / grid.x) * push.size / grid;
    int n = int(at.y * push.size.x + at.x);
    float s = finite(FETCH(intrinsic, n)).w;
    float weight = MATTE ? min(finite(FETCH(mask, n)).x, 1.0) : 1.0;
    if (s > kShadingFloor) sum += weight * vec4(log2(s), 1.0, 0.0, 0.0);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x > 0u) return;
  vec4 before = push.fresh == 0u ? LOAD(level, 0) : vec4(0.0);
  if (!(sum.y > 0.0)) {
    STORE(level, 0, before);
    return;
  }
  float now = sum.x / sum.y, apart = now - before.x;
  bool follows = before.y > 0.0 && abs(apart) < kJump;
  STORE(level, 0, vec4(follows ? before.x + kFollow * apart : now, 1.0, 0.0, 0.0));
}
