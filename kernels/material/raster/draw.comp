// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "visible.glsl"

// Image of a mesh: linear RGB times coverage, and coverage. Each triangle visible in a pixel is shaded there from a lit
// sphere.
PLANE_IN(3, placed);
PLANE_IN(4, LIT_TABLE);
PLANE_OUT(5, picture);
#define LIT_TABLE LIT_TABLE
#include "environment/lit_sphere.glsl"
#include "visible_surface.glsl"

vec3 shade(int who, vec2 at) { return lit_sphere(surface_at(who, at).normal, push.side); }

void main() {
  uvec2 at = pixel_of(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, push.size))) return;
  Seen seen[2];
  find_visible(at, seen);
  // Points of the same triangle are shaded once, at their mean.
  vec4 sum = vec4(0.0);
  int who = largest(seen);
  while (who != kNone) {
    vec4 first = vec4(equal(seen[0].who, ivec4(who))), second = vec4(equal(seen[1].who, ivec4(who)));
    float count = dot(first + second, vec4(1.0));
    vec2 middle = vec2(dot(first, kAcross[0]) + dot(second, kAcross[1]), dot(first, kDown[0]) + dot(second, kDown[1]));
    sum += count * vec4(shade(who, vec2(at) + middle / count), 1.0);
    seen[0].who = mix(seen[0].who, ivec4(kNone), greaterThan(first, vec4(0.0)));
    seen[1].who = mix(seen[1].who, ivec4(kNone), greaterThan(second, vec4(0.0)));
    who = largest(seen);
  }
  STORE(picture, push.first + at.y * push.stride + at.x, sum / 8.0);
}
