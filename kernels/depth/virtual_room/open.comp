// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// How much of the light from all around reaches places of the solids: the mean over directions, spread as their cosine is, of whether
// nothing is within kReach. One place an invocation.
PLANE_IN(0, scene);
SCALAR_OUT(1, openness);
layout(push_constant) uniform Push { uint solids; } push;

#define SCENE(index) FETCH(scene, index)
#include "room.glsl"

const uint kDirections = 64u;
const float kReach = 0.9;   // meters
const float kLift = 1e-3;   // meters, of rays off the surface
const float kInset = 0.98;  // of the outermost places: corners are closed

// A spiral of golden angles over the half ball about a normal.
vec3 direction(uint i, vec3 normal) {
  float up = (float(i) + 0.5) / float(kDirections), angle = 2.399963 * float(i), level = sqrt(1.0 - up);
  vec3 x = normalize(abs(normal.y) < 0.9 ? cross(normal, vec3(0.0, 1.0, 0.0)) : cross(normal, vec3(1.0, 0.0, 0.0)));
  return level * (cos(angle) * x + sin(angle) * cross(normal, x)) + sqrt(up) * normal;
}

void main() {
  uint line = line_index(), places = uint(kOpenSide * kOpenSide), i = line / (6u * places);
  if (i >= push.solids) return;
  uint face = line / places % 6u, at = line % places;
  int axis = int(face / 2u);
  vec2 uv = kInset * (2.0 * vec2(at % uint(kOpenSide), at / uint(kOpenSide)) / float(kOpenSide - 1) - 1.0);
  vec3 side;
  side[axis] = face % 2u == 1u ? 1.0 : -1.0;
  side[(axis + 1) % 3] = uv.x;
  side[(axis + 2) % 3] = uv.y;
  Solid s = solid_of(i);
  vec3 p = s.kind == kBall ? normalize(side) * s.half_size.x : side * s.half_size;
  vec3 normal = out_of(s, normal_in(s, p)), from = s.center + out_of(s, p) + kLift * normal;
  float free = 0.0;
  for (uint n = 0u; n < kDirections; ++n) free += open(from, direction(n, normal), kReach);
  STORE(openness, line, free / float(kDirections));
}
