// SPDX-License-Identifier: LGPL-2.1-or-later
// The surface of a triangle at a point of the picture. Needs visible.glsl and PLANE_IN placed.

// A corner in camera axes: x right, y up, z towards the camera.
vec3 place_of(vec4 corner) {
  return push.lens.x > 0.0 ? vec3((corner.xy - push.lens.zw) / push.lens.xy * vec2(1.0, -1.0), -1.0) / corner.z
                           : vec3(corner.x, -corner.y, corner.z);
}

struct Surface {
  vec3 normal;  // unit, in camera axes
  float depth;  // place.comp
};

Surface surface_at(int who, vec2 at) {
  vec4 p = FETCH(records, 4 * who), q = FETCH(records, 4 * who + 1), r = FETCH(records, 4 * who + 2);
  ivec3 corner = 2 * ivec3(FETCH(records, 4 * who + 3).xyz);
  vec3 weight = vec3(dot(p.xyz, vec3(at, 1.0)), dot(q.xyz, vec3(at, 1.0)), dot(r.xyz, vec3(at, 1.0)));
  vec3 n = weight.x * FETCH(placed, corner.x + 1).xyz + weight.y * FETCH(placed, corner.y + 1).xyz +
           weight.z * FETCH(placed, corner.z + 1).xyz;
  // The visible side may be the inner one, of a mesh that is not closed.
  vec3 a = place_of(FETCH(placed, corner.x)), u = place_of(FETCH(placed, corner.y)) - a, v = place_of(FETCH(placed, corner.z)) - a;
  vec3 flat_normal = cross(u, v);
  flat_normal *= dot(flat_normal, push.lens.x > 0.0 ? -a : vec3(0.0, 0.0, 1.0)) < 0.0 ? -1.0 : 1.0;
  if (dot(n, flat_normal) < 0.0) n = -n;
  float length2 = dot(n, n);
  float depth = dot(weight, vec3(p.w, q.w, r.w)) / max(weight.x + weight.y + weight.z, 1e-30);
  return Surface(length2 > 0.0 ? n * inversesqrt(length2) : vec3(0.0, 0.0, 1.0), depth);
}

int largest(Seen seen[2]) {
  ivec4 both = max(seen[0].who, seen[1].who);
  return max(max(both.x, both.y), max(both.z, both.w));
}
