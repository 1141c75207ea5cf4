// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "edit.glsl"

// One workgroup: the color of what the mask selects, K = Σ matte² R / Σ matte², over a sample of the pixels. Averaged over frames, so
// that a change of the mask does not change the brightness of all of the object at once.
PLANE_IN(0, intrinsic);
PLANE_IN(1, mask);
PLANE_INOUT(2, key);  // one vec4: K, 1 if there is one
layout(push_constant) uniform Push {
  uvec2 size;
  float rate;  // of this frame
} push;

const uint kMaskSampleSide = 128u;

void main() {
  vec4 sum = vec4(0.0);
  uvec2 grid = min(push.size, uvec2(kMaskSampleSide));
  for (uint i = gl_LocalInvocationID.x; i < grid.x * grid.y; i += gl_WorkGroupSize.x) {
    uvec2 at = uvec2(i % grid.x, i / grid.x) * push.size / grid;
    int n = int(at.y * push.size.x + at.x);
    float matte = min(finite(FETCH(mask, n)).x, 1.0);
    if (matte > 0.0) sum += matte * matte * vec4(finite(FETCH(intrinsic, n)).rgb, 1.0);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x > 0u || !(sum.w > 0.0)) return;
  vec4 before = LOAD(key, 0), now = vec4(sum.rgb / sum.w, 1.0);
  STORE(key, 0, before.w > 0.0 ? mix(before, now, push.rate) : now);
}
