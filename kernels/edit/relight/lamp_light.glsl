// SPDX-License-Identifier: LGPL-2.1-or-later
// Light of one lamp of the table `lamps` (PLANE_IN) on a surface. Needs relight.glsl and edit.glsl.
const int kPoint = 0;
const int kSpot = 1;
const int kDirectional = 2;
const float kMinDistance2 = 1e-12;

vec3 light_of(int k, vec3 place, vec3 normal) {
  vec4 lamp = FETCH(lamps, kLampRows * k + kPlace), axis = FETCH(lamps, kLampRows * k + kAxis);
  vec4 color = FETCH(lamps, kLampRows * k + kLight);
  int kind = int(axis.w);
  if (kind == kDirectional) return color.rgb * max(-dot(normal, axis.xyz), 0.0);
  vec3 to = lamp.xyz - place;
  float square = max(dot(to, to), kMinDistance2);
  vec3 way = to * inversesqrt(square);
  float share = max(dot(normal, way), 0.0) / max(square, lamp.w);
  if (kind == kSpot)
    share *= 1.0 - falling((-dot(way, axis.xyz) - color.w) * FETCH(lamps, kLampRows * k + kMark).z);
  return color.rgb * share;
}
