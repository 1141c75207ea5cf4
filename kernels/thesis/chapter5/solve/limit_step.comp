// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"

// A Gauss-Newton step ends: it moves r by kLargestStep at most and keeps everything within what single precision can
// square. In place; the dispatch's z is the plane of the field.
PLANE_IN(0, state);
PLANE_IN(1, next);
PLANE_OUT(2, next_out);

const float kLargestStep = 1.0, kSmallestLog = -12.0, kLargestLog = 6.0, kLargestLight = 65504.0;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int group = int(gl_WorkGroupID.z);
  int n = (group * push.size.y + at.y) * push.size.x + at.x;
  vec4 result = FETCH(next, n);
  vec4 light = clamp(result, -kLargestLight, kLargestLight);
  vec3 from = FETCH(state, n).rgb;
  vec3 r = clamp(clamp(result.rgb, from - kLargestStep, from + kLargestStep), kSmallestLog, kLargestLog);
  STORE(next_out, n, group == 0 ? vec4(r, light.w) : light);
}
