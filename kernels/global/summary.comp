#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../image/workgroup_sum.glsl"
#include "model.glsl"

// One workgroup: every base color's part of the frame's mean color, and its share of the points; what the frame's points
// count on the average.
PLANE_IN(0, colors);
WORD_IN(1, labels);
PLANE_OUT(2, means);  // kSlots
PLANE_INOUT(3, scene);
layout(push_constant) uniform Push { SIZES } push;

void main() {
  int count = push.grid.x * push.grid.y;
  vec4 part[kSlots], all = vec4(0.0);
  for (int k = 0; k < kSlots; ++k) part[k] = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < count; i += int(gl_WorkGroupSize.x)) {
    vec4 color = FETCH(colors, i);
    int label = int(FETCH1(labels, i));
    for (int k = 0; k < kSlots; ++k)
      if (k == label) part[k] += vec4(color.rgb, 1.0);
    all.x += color.w;
  }
  all = workgroup_sum(all);
  for (int k = 0; k < kSlots; ++k) {
    vec4 sum = workgroup_sum(part[k]) / float(count);
    if (gl_LocalInvocationID.x == 0u) STORE(means, k, sum);
  }
  if (gl_LocalInvocationID.x == 0u) LOAD(scene, SCENE_AMOUNT).z = all.x / float(count) + 1e-9;
}
