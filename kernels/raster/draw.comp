#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "visible.glsl"

// The picture of a mesh: linear RGB times coverage, and coverage. Each of eight points of a pixel is shaded by itself, from
// a lit sphere.
PLANE_IN(2, placed);
PLANE_IN(3, LIT_TABLE);
PLANE_OUT(4, picture);
#define LIT_TABLE LIT_TABLE
#include "../environment/lit_sphere.glsl"

vec3 shade(int who, vec2 at) {
  vec3 p = FETCH(records, 4 * who).xyz, q = FETCH(records, 4 * who + 1).xyz, r = FETCH(records, 4 * who + 2).xyz;
  ivec3 corner = 2 * ivec3(FETCH(records, 4 * who + 3).xyz);
  vec3 weight = vec3(dot(p, vec3(at, 1.0)), dot(q, vec3(at, 1.0)), dot(r, vec3(at, 1.0)));
  vec3 n = weight.x * FETCH(placed, corner.x + 1).xyz + weight.y * FETCH(placed, corner.y + 1).xyz +
           weight.z * FETCH(placed, corner.z + 1).xyz;
  // The side that is seen may be the inner one, of a mesh that is not closed.
  vec3 a = FETCH(placed, corner.x).xyz, u = FETCH(placed, corner.y).xyz - a, v = FETCH(placed, corner.z).xyz - a;
  vec3 flat_normal = cross(vec3(u.x, -u.y, u.z), vec3(v.x, -v.y, v.z));
  flat_normal *= flat_normal.z < 0.0 ? -1.0 : 1.0;
  if (dot(n, flat_normal) < 0.0) n = -n;
  float length2 = dot(n, n);
  return lit_sphere(length2 > 0.0 ? n * inversesqrt(length2) : vec3(0.0, 0.0, 1.0), push.side);
}

void main() {
  uvec2 at = pixel_of(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, push.size))) return;
  Seen seen[2];
  look(at, seen);
  vec4 sum = vec4(0.0);
  for (int half_of = 0; half_of < 2; ++half_of)
    for (int i = 0; i < 4; ++i) {
      int who = half_of == 0 ? seen[0].who[i] : seen[1].who[i];
      vec2 offset = half_of == 0 ? vec2(kAcross[0][i], kDown[0][i]) : vec2(kAcross[1][i], kDown[1][i]);
      vec3 color = shade(max(who, 0), vec2(at) + offset);
      if (who != kNobody) sum += vec4(color, 1.0);
    }
  STORE(picture, at.y * push.size.x + at.x, sum / 8.0);
}
