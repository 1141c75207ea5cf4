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

vec3 shade(int who, vec2 at) {
  vec3 p = FETCH(records, 4 * who).xyz, q = FETCH(records, 4 * who + 1).xyz, r = FETCH(records, 4 * who + 2).xyz;
  ivec3 corner = 2 * ivec3(FETCH(records, 4 * who + 3).xyz);
  vec3 weight = vec3(dot(p, vec3(at, 1.0)), dot(q, vec3(at, 1.0)), dot(r, vec3(at, 1.0)));
  vec3 n = weight.x * FETCH(placed, corner.x + 1).xyz + weight.y * FETCH(placed, corner.y + 1).xyz +
           weight.z * FETCH(placed, corner.z + 1).xyz;
  // The visible side may be the inner one, of a mesh that is not closed.
  vec3 a = FETCH(placed, corner.x).xyz, u = FETCH(placed, corner.y).xyz - a, v = FETCH(placed, corner.z).xyz - a;
  vec3 flat_normal = cross(vec3(u.x, -u.y, u.z), vec3(v.x, -v.y, v.z));
  flat_normal *= flat_normal.z < 0.0 ? -1.0 : 1.0;
  if (dot(n, flat_normal) < 0.0) n = -n;
  float length2 = dot(n, n);
  return lit_sphere(length2 > 0.0 ? n * inversesqrt(length2) : vec3(0.0, 0.0, 1.0), push.side);
}

int largest(Seen seen[2]) {
  ivec4 both = max(seen[0].who, seen[1].who);
  return max(max(both.x, both.y), max(both.z, both.w));
}

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
  STORE(picture, at.y * push.size.x + at.x, sum / 8.0);
}
