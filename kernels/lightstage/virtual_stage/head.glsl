// SPDX-License-Identifier: LGPL-2.1-or-later
// A head made of ellipsoids, ray-marched by surface.comp and lit by shade.comp. Needs SCENE(index), the vec4s of a
// HeadScene.
//
// An ellipsoid is four vec4: the rows of M in xyz, which maps an offset from its center c to the unit ball, and c in
// their w; then its smallest radius, blend k, kind, material. Its distance, to first order (k0 = |M p|, p from c):
//   d = k0 (k0 - 1) / |Mᵀ M p|
// Solids are joined smoothly with those before, carvings are subtracted from them:
//   smin(a, b) = min(a, b) - h²k/4,  h = max(k - |a - b|, 0) / k        smax(a, -b) = -smin(-a, b)
const int kPrimitiveVec4s = 4;
const float kSolid = 0.0, kCarving = 1.0;

struct Primitive {
  vec3 row0, row1, row2, center;
  float radius, blend, kind, material;
};

Primitive primitive(uint i) {
  int at = int(i) * kPrimitiveVec4s;
  vec4 a = SCENE(at), b = SCENE(at + 1), c = SCENE(at + 2), d = SCENE(at + 3);
  return Primitive(a.xyz, b.xyz, c.xyz, vec3(a.w, b.w, c.w), d.x, d.y, d.z, d.w);
}

vec3 to_ball(Primitive e, vec3 v) { return vec3(dot(e.row0, v), dot(e.row1, v), dot(e.row2, v)); }

float distance_to(Primitive e, vec3 at) {
  vec3 q = to_ball(e, at - e.center);
  float k0 = length(q);
  vec3 gradient = e.row0 * q.x + e.row1 * q.y + e.row2 * q.z;
  return k0 * (k0 - 1.0) / max(length(gradient), 1e-9);
}

float smooth_min(float a, float b, float k) {
  float h = max(k - abs(a - b), 0.0) / k;
  return min(a, b) - 0.25 * h * h * k;
}

float head_distance(vec3 at, uint primitives) {
  float d = 1e9;
  for (uint i = 0u; i < primitives; ++i) {
    Primitive e = primitive(i);
    float own = distance_to(e, at);
    d = e.kind == kCarving ? -smooth_min(-d, own, e.blend) : smooth_min(d, own, e.blend);
  }
  return d;
}
