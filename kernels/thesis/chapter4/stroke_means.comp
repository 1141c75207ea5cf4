// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "image/pack4.glsl"

// The auxiliary variables of strokes (4.6.2), as strokes.glsl reads them: means by weight. A workgroup has a stroke.
PLANE_IN(0, stroke_mask);
SCALAR_IN(1, kinds);  // of a stroke: 1 if its reflectance is constant, 0 if its shading is
PLANE_IN(2, solution);
PLANE_OUT(3, stroke_means);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  int stroke = int(gl_WorkGroupID.x);
  bool reflectance = FETCH1(kinds, stroke) > 0.0;
  uint packs = PACK4(push.size.x), blocks = packs * ((push.size.y + 3u) / 4u);
  vec4 sum = vec4(0.0);  // of the values, and of the weights
  for (uint i = gl_LocalInvocationIndex; i < blocks; i += gl_WorkGroupSize.x) {
    uvec2 at = uvec2(i % packs, i / packs * 4u);
    for (uint row = 0u; row < 4u; ++row) {
      uint y = at.y + row;
      vec4 mask = y < push.size.y ? FETCH(stroke_mask, int(y * packs + at.x)) : vec4(0.0);
      for (uint k = 0u; k < 4u; ++k) {
        if (int(mask[k]) != stroke + 1) continue;
        float weight = 2.0 * fract(mask[k]);
        vec4 x = FETCH(solution, int(y * push.size.x + 4u * at.x + k));
        sum += weight * vec4(reflectance ? x.rgb : vec3(x.a, 0.0, 0.0), 1.0);
      }
    }
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationIndex == 0u)
    STORE(stroke_means, stroke, vec4(sum.w > 0.0 ? sum.rgb / sum.w : vec3(0.0), float(reflectance)));
}
