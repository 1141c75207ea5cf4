// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "image/pack4.glsl"

// The auxiliary variables of strokes (4.6.2), as strokes.glsl reads them: means by weight; and how far the solution is from them. A
// workgroup has a stroke.
PLANE_IN(0, stroke_mask);
SCALAR_IN(1, kinds);  // of a stroke: 1 if its reflectance is constant, 0 if its shading is
PLANE_IN(2, solution);
PLANE_OUT(3, stroke_means);
PLANE_OUT(4, stroke_spreads);  // .x: rms
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  int stroke = int(gl_WorkGroupID.x);
  bool reflectance = FETCH1(kinds, stroke) > 0.0;
  uint packs = PACK4(push.size.x), blocks = packs * ((push.size.y + 3u) / 4u);
  vec4 sum = vec4(0.0);  // of the values, and of the weights
  float squares = 0.0;
  for (uint i = gl_LocalInvocationIndex; i < blocks; i += gl_WorkGroupSize.x) {
    uvec2 at = uvec2(i % packs, i / packs * 4u);
    for (uint row = 0u; row < 4u; ++row) {
      uint y = at.y + row;
      vec4 mask = y < push.size.y ? FETCH(stroke_mask, int(y * packs + at.x)) : vec4(0.0);
      for (uint k = 0u; k < 4u; ++k) {
        if (int(mask[k]) != stroke + 1) continue;
        float weight = 2.0 * fract(mask[k]);
        vec4 x = FETCH(solution, int(y * push.size.x + 4u * at.x + k));
        vec3 value = reflectance ? x.rgb : vec3(x.a, 0.0, 0.0);
        sum += weight * vec4(value, 1.0);
        squares += weight * dot(value, value);
      }
    }
  }
  sum = workgroup_sum(sum);
  squares = workgroup_sum(vec4(squares)).x;
  if (gl_LocalInvocationIndex > 0u) return;
  vec3 mean = sum.w > 0.0 ? sum.rgb / sum.w : vec3(0.0);
  STORE(stroke_means, stroke, vec4(mean, float(reflectance)));
  float square = sum.w > 0.0 ? max(squares / sum.w - dot(mean, mean), 0.0) : 0.0;
  STORE(stroke_spreads, stroke, vec4(sqrt(square / (reflectance ? 3.0 : 1.0))));
}
