// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"

// One direction of a separable bilateral filter of reflectance: a mean over neighbors, weighted by their distance and by the
// difference of their ln R from the pixel's.
layout(constant_id = 1) const bool DOWN = false;
PLANE_IN(0, intrinsic);
PLANE_OUT(1, flattened);  // w as in `intrinsic`
layout(push_constant) uniform Push {
  uvec2 size;
  int radius;
  float fall_off;     // 1 / (2 sigma^2) of distance
  float range_scale;  // 1 / (2 sigma^2) of ln R
  uint first_row;
} push;

vec3 log_reflectance(vec3 r) { return log(max(r, vec3(kReflectanceFloor))); }

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y);
  ivec2 size = ivec2(push.size);
  if (at.x >= size.x || at.y >= size.y) return;
  int n = at.y * size.x + at.x;
  vec4 own = finite(FETCH(intrinsic, n));
  vec3 own_log = log_reflectance(own.rgb);
  vec4 sum = vec4(own.rgb, 1.0);
  for (int k = -push.radius; k <= push.radius; ++k) {
    ivec2 other = at + (DOWN ? ivec2(0, k) : ivec2(k, 0));
    if (k == 0 || min(other.x, other.y) < 0 || other.x >= size.x || other.y >= size.y) continue;
    vec3 r = finite(FETCH(intrinsic, other.y * size.x + other.x)).rgb;
    vec3 apart = log_reflectance(r) - own_log;
    float weight = exp(-float(k * k) * push.fall_off - min(dot(apart, apart) * push.range_scale, 80.0));
    sum += weight * vec4(r, 1.0);
  }
  STORE(flattened, BY_ROWS(n), vec4(sum.rgb / sum.w, own.w));
}
