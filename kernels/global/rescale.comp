#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../image/workgroup_sum.glsl"
#include "model.glsl"

// One workgroup: by what factor mean shading differs from what it was thought to be, from a sample of pixels.
PLANE_IN(0, intrinsic);
PLANE_INOUT(1, scene);
layout(push_constant) uniform Push { ivec2 size; } push;

const int kSide = 128;  // of the sample at most

void main() {
  ivec2 sample_size = min(push.size, kSide);
  int count = sample_size.x * sample_size.y;
  vec4 sum = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < count; i += int(gl_WorkGroupSize.x)) {
    ivec2 at = (2 * ivec2(i % sample_size.x, i / sample_size.x) + 1) * push.size / (2 * sample_size);
    sum.x += FETCH(intrinsic, at.y * push.size.x + at.x).w;
  }
  sum = workgroup_sum(sum);
  if (gl_LocalInvocationID.x == 0u)
    LOAD(scene, SCENE_TINT).w = (sum.x / float(count) + 1e-12) / (LOAD(scene, SCENE_TINT).z + 1e-12);
}
