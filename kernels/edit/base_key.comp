// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "edit.glsl"
#define MODEL_BINDING 1
#include "base_selection.glsl"

// One workgroup: the color of the surfaces of a base color, since base colors of some methods are chromaticities only:
//
//   K = Σ w R / Σ w, w = selection · mean R S, over a sample of the pixels (the base color itself if none is selected).
PLANE_OUT(0, key);  // one vec4: K, 1
layout(push_constant) uniform Push {
  uvec2 size;
  int index;
  float fall_off;  // 1 / softness
} push;

void main() {
  vec4 sum = vec4(0.0);
  uvec2 grid = min(push.size, uvec2(kSampleSide));
  for (uint i = gl_LocalInvocationID.x; i < grid.x * grid.y; i += gl_WorkGroupSize.x) {
    uvec2 at = uvec2(i % grid.x, i / grid.x) * push.size / grid;
    vec4 own = finite(FETCH(model, int(at.y * push.size.x + at.x)));
    float w = base_selection(own, push.index, push.fall_off) * min(mean3(own.rgb) * own.w, kLargest);
    sum += w * vec4(own.rgb, 1.0);
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x > 0u) return;
  STORE(key, 0, vec4(sum.w > 0.0 ? sum.rgb / sum.w : finite(FETCH(bases, push.index)).rgb, 1.0));
}
