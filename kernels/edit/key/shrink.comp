// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "key.glsl"

// The smallest (GROW: largest) x within `radius` pixels, along rows or (DOWN) columns.
layout(constant_id = 1) const bool DOWN = false;
layout(constant_id = 2) const bool GROW = false;
PLANE_IN(0, matte);
PLANE_OUT(1, shrunk);
layout(push_constant) uniform Push {
  ivec2 size;
  float radius;
  uint first_row;
} push;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.x, int(push.first_row + gl_GlobalInvocationID.y));
  if (at.x >= push.size.x || at.y >= push.size.y) return;
  int n = at.y * push.size.x + at.x, whole = int(floor(push.radius));
  vec4 own = FETCH(matte, n);
  float found = own.x, within = own.x;
  for (int k = 1; k <= whole + 1; ++k) {
    if (k == whole + 1) within = found;
    for (int side = -1; side <= 1; side += 2) {
      ivec2 there = clamp(at + side * (DOWN ? ivec2(0, k) : ivec2(k, 0)), ivec2(0), push.size - 1);
      float x = FETCH(matte, there.y * push.size.x + there.x).x;
      found = GROW ? max(found, x) : min(found, x);
    }
  }
  float x = mix(within, found, push.radius - float(whole));
  STORE(shrunk, BY_ROWS(n), x > 0.0 && x < 1.0 ? vec4(x, own.yzw) : vec4(x, 0.0, 0.0, 0.0));
}
