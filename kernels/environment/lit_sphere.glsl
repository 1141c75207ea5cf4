// SPDX-License-Identifier: LGPL-2.1-or-later
// Normals of a lit sphere's table and lookup (lit_sphere.hpp).
//
// Maps the hemisphere z > 0 to the unit disc with equal areas (Lambert): p = n.xy / sqrt(1 + n.z).

vec3 lit_normal(vec2 p) {
  float r2 = dot(p, p);
  if (r2 > 1.0) return vec3(p * inversesqrt(r2), 0.0);  // beyond the rim: as on it
  return vec3(p * sqrt(2.0 - r2), 1.0 - r2);
}

#ifdef LIT_TABLE
// Linear RGB for a unit normal, from a table that the kernel has bound by the name LIT_TABLE (and defined as itself,
// because names are pasted). Normals that face away use the rim.
vec3 lit_sphere(vec3 n, uint side) {
  float flat2 = dot(n.xy, n.xy);
  vec2 p = n.z > 0.0 ? n.xy * inversesqrt(1.0 + n.z) : n.xy * inversesqrt(max(flat2, 1e-12));
  vec2 at = clamp((vec2(p.x, -p.y) * 0.5 + 0.5) * float(side) - 0.5, vec2(0.0), vec2(float(side) - 1.001));
  uvec2 cell = uvec2(at);
  vec2 f = at - vec2(cell);
  int i = int(cell.y * side + cell.x), j = i + int(side);
  vec3 top = mix(FETCH(LIT_TABLE, i).rgb, FETCH(LIT_TABLE, i + 1).rgb, f.x);
  vec3 bottom = mix(FETCH(LIT_TABLE, j).rgb, FETCH(LIT_TABLE, j + 1).rgb, f.x);
  return mix(top, bottom, f.y);
}
#endif
