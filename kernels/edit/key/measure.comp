// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "key.glsl"

// One workgroup: the screen's mean reflectance, of a sample of pixels whose hue is within 60 degrees of the key's, or of what is
// at the frame's border; then of those near that. Follows its measurement over some frames, and jumps if that is far away.
layout(constant_id = 1) const bool BORDER = false;
PLANE_IN(0, intrinsic);
PLANE_INOUT(1, screen);  // one vec4: reflectance, 1 if a screen is known
layout(push_constant) uniform Push {
  uvec2 size;
  float key_r, key_g, key_b;
  uint fresh;  // 1: forget the frames before
} push;

const float kFollow = 0.125;   // share of the way to the measurement, a frame
const float kJump = 0.5;       // distance of chromaticity
const float kWidths[3] = float[](1.0, 0.6, 0.4);  // distance of chromaticity that counts, step by step
const float kShareMin = 0.01;    // of the sample, that show a screen

bool counts(uvec2 at) {
  uvec2 margin = (push.size + 7u) / 8u;
  return !BORDER || any(lessThan(at, margin)) || any(greaterThanEqual(at + margin, push.size));
}

vec4 mean_where(vec3 direction, vec3 near, float width) {
  vec4 sum = vec4(0.0);
  uvec2 grid = min(push.size, uvec2(kSampleSide));
  for (uint i = gl_LocalInvocationID.x; i < grid.x * grid.y; i += gl_WorkGroupSize.x) {
    uvec2 at = uvec2(i % grid.x, i / grid.x) * push.size / grid;
    vec3 paint = bounded(FETCH(intrinsic, int(at.y * push.size.x + at.x))).rgb;
    float value = mean3(paint);
    if (!counts(at) || !(value > kReflectanceFloor)) continue;
    float weight = width > 0.0 ? falling(distance(paint / value, near) / width) : 1.0;
    if (dot(direction, direction) > 0.0) weight *= clamp(excess(paint, direction) / value, 0.0, 1.0);
    sum += weight * vec4(paint, 1.0);
  }
  return workgroup_sum(sum);
}

void main() {
  vec4 before = push.fresh == 0u ? LOAD(screen, 0) : vec4(0.0);
  uvec2 grid = min(push.size, uvec2(kSampleSide));
  // The key's hue. That of a border is the sum of what it shows.
  vec3 q = chroma(BORDER ? mean_where(vec3(0.0), vec3(0.0), 0.0).rgb : vec3(push.key_r, push.key_g, push.key_b));
  vec4 found = vec4(0.0);
  bool known = length(q) > 1e-6;
  if (known) {
    vec3 direction = q / length(q);
    found = mean_where(direction, vec3(0.0), 0.0);
    for (int k = 0; k < 3; ++k) {
      float value = mean3(found.rgb);
      if (value > 0.0) found = mean_where(direction, found.rgb / value, kWidths[k]);
    }
    float value = mean3(found.rgb);
    known = found.w >= kShareMin * float(grid.x * grid.y) && length(chroma(found.rgb)) > kSaturated * value;
  }
  if (gl_LocalInvocationID.x > 0u) return;
  if (!known) {
    STORE(screen, 0, before);
    return;
  }
  vec3 now = found.rgb / found.w;
  bool follows = before.w > 0.0 && distance(before.rgb / mean3(before.rgb), now / mean3(now)) < kJump;
  STORE(screen, 0, vec4(follows ? mix(before.rgb, now, kFollow) : now, 1.0));
}
