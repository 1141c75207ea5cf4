// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "lit_sphere.glsl"

// Radiance of a surface for each normal n of a table (thesis Eq. 6.1-6.3, k = 1/pi, viewer v = +z, far away):
//   D(n) = 1/pi ∫_{w·n>0} (w·n) E(w) dw
//   S(n) = 1/pi ∫_{w·n>0} (h·n)^s E(w) dw         h halfway between w and v
// D, and S of broad lobes, are sums over cells of the light. S of narrow lobes is a mean over samples (dw = 4 (v·h) dh):
//   S(n) = 8/(s+1) · mean of (v·h) E(reflect(v,h)) over h drawn from (s+1)/(2 pi) (h·n)^s
PLANE_IN(0, cells);    // flux and mean direction by turns
PLANE_IN(1, light);    // levels of the map, one after the other
PLANE_IN(2, samples);  // h around +z; w = level for v·h = 1
PLANE_OUT(3, table);
layout(push_constant) uniform Push {
  vec4 diffuse;   // md · intensity
  vec4 turn;      // quaternion, from the viewer's axes to those of the light
  float gloss;    // ms · intensity
  float shininess;
  float spread;   // radius of a sample at level 0
  uint side, cells;
  uint broad;     // cells that S is a sum over: all or none
  uint samples;   // that S is a mean of: none or all
  uint rows;      // of level 0
  uint levels;
} push;

const float kPi = 3.14159265358979;

// Rotates from the viewer's axes to those of the light.
vec3 turned(vec3 a) {
  vec3 t = 2.0 * cross(push.turn.xyz, a);
  return a + push.turn.w * t + cross(push.turn.xyz, t);
}

vec3 bilinear(uint level, vec2 angle) {  // azimuth in turns from the center column on, polar angle in halves of one
  int rows = int(push.rows >> level), columns = 2 * rows;
  // Levels before it have 2 rows0² (1 + 1/4 + …) texels.
  int first = int((8u * push.rows * push.rows - (8u * push.rows * push.rows >> (2u * level))) / 3u);
  float x = fract(angle.x + 0.5) * float(columns) - 0.5, y = clamp(angle.y * float(rows) - 0.5, 0.0, float(rows) - 1.0);
  float left = floor(x), top = min(floor(y), float(rows - 2));
  vec2 f = vec2(x - left, y - top);
  int u = int(left), v = first + int(top) * columns;
  int u0 = u < 0 ? u + columns : u, u1 = u + 1 >= columns ? u + 1 - columns : u + 1;
  vec3 above = mix(FETCH(light, v + u0).rgb, FETCH(light, v + u1).rgb, f.x);
  vec3 below = mix(FETCH(light, v + columns + u0).rgb, FETCH(light, v + columns + u1).rgb, f.x);
  return mix(above, below, f.y);
}

vec3 radiance(vec3 w, float level) {
  float l = clamp(level, 0.0, float(push.levels - 1u));
  uint lower = min(uint(l), push.levels - 2u);
  w = turned(w);
  vec2 angle = vec2(atan(w.x, w.z) / (2.0 * kPi), acos(clamp(w.y, -1.0, 1.0)) / kPi);
  return mix(bilinear(lower, angle), bilinear(lower + 1u, angle), l - float(lower));
}

vec3 diffuse(vec3 n) {
  vec3 axis = turned(n), sum = vec3(0.0);
  for (uint i = 0u; i < push.cells; ++i)
    sum += FETCH(cells, int(2u * i)).rgb * max(dot(FETCH(cells, int(2u * i + 1u)).xyz, axis), 0.0);
  return sum / kPi;
}

vec3 broad(vec3 n) {
  vec3 axis = turned(n), viewer = turned(vec3(0.0, 0.0, 1.0)), sum = vec3(0.0);
  for (uint i = 0u; i < push.broad; ++i) {
    vec3 w = FETCH(cells, int(2u * i + 1u)).xyz;
    // The light of a cell, whose mean direction is shorter the wider the cell is, rises above the horizon gradually.
    float narrow = max(dot(w, w), 1e-12), radius = sqrt(max(1.5 * (1.0 - narrow), 1e-6));
    w *= inversesqrt(narrow);
    vec3 h = w + viewer;
    float lobe = dot(h, axis) * inversesqrt(max(dot(h, h), 1e-12));
    float seen = clamp(0.5 + 0.5 * dot(w, axis) / radius, 0.0, 1.0);
    sum += FETCH(cells, int(2u * i)).rgb * (seen * pow(max(lobe, 0.0), push.shininess));
  }
  return sum / kPi;
}

vec3 glossy(vec3 n) {
  // A frame around n without a discontinuity on this hemisphere (Duff et al. 2017).
  float a = -1.0 / (1.0 + n.z), b = n.x * n.y * a;
  vec3 tangent = vec3(1.0 + n.x * n.x * a, b, -n.x), bitangent = vec3(b, 1.0 + n.y * n.y * a, -n.y);
  vec3 sum = vec3(0.0);
  for (uint i = 0u; i < push.samples; ++i) {
    vec4 s = FETCH(samples, int(i));
    vec3 h = s.x * tangent + s.y * bitangent + s.z * n;
    float facing = h.z;
    float near = max(facing, 1e-4);
    vec3 w = 2.0 * facing * h - vec3(0.0, 0.0, 1.0);
    // A sample represents an area of the sphere, which may cross the horizon.
    float radius = exp2(s.w) * push.spread * sqrt(near);
    float seen = clamp(0.5 + 0.5 * dot(w, n) / radius, 0.0, 1.0);
    float weight = facing > 0.0 ? facing * seen : 0.0;
    sum += weight * radiance(w, s.w + 0.5 * log2(near));
  }
  return push.samples > 0u ? 8.0 / (push.shininess + 1.0) / float(push.samples) * sum : sum;
}

void main() {
  uint i = line_index();
  if (i >= push.side * push.side) return;
  uvec2 at = uvec2(i % push.side, i / push.side);
  vec2 p = (vec2(at) + 0.5) / float(push.side) * 2.0 - 1.0;
  vec3 n = lit_normal(vec2(p.x, -p.y));
  STORE(table, i, vec4(push.diffuse.rgb * diffuse(n) + push.gloss * (broad(n) + glossy(n)), 1.0));
}
