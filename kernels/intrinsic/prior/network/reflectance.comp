// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "fields.glsl"
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "intrinsic/guide/guide.glsl"

// The fields of fields.glsl from a network that estimates reflectance: its steps say which edges are paint, and what it leaves of the
// picture is the target of shading. One pixel of the network's picture an invocation.
PLANE_IN(0, level0);
PLANE_IN(1, level1);
PLANE_IN(2, cells);
PLANE_IN(3, reflectance);
PLANE_OUT(4, fields);
layout(push_constant) uniform Push {
  ivec2 size;     // of the frame
  ivec2 network;  // of the network's picture
  int padded_width;
  int level;
} push;

#include "picture.glsl"

const float kEdge = 2.0, kTrust = 1.5;             // changes of ln a and ln b at most, and of ln v and ln g
const float kEven = 0.05;                          // steps of ln R and ln S that say little
const float kDarkest = 1e-3, kBrightest = 1e3;     // reflectance
const float kReach = 6.0;                          // of V
const float kUnknown = 1e30;

// Mean ln R at a pixel, kUnknown where a channel is NaN, and m of the guide.
vec2 seen_at(ivec2 at) {
  at = clamp(at, ivec2(0), push.network - 1);
  float m = mean_guide(at).x;
  vec3 r = FETCH(reflectance, 1 + at.y * push.padded_width + at.x).rgb;
  if (any(greaterThan(floatBitsToInt(r) & ivec3(0x7fffffff), ivec3(0x7f800000)))) return vec2(kUnknown, m);
  r = log(clamp(r, kDarkest, kBrightest));
  return vec2((r.r + r.g + r.b) / 3.0, m);
}

// |step| of ln R and of ln S between two pixels.
vec2 step_between(vec2 from, vec2 to) {
  if (from.x == kUnknown || to.x == kUnknown) return vec2(0.0);
  float paint = to.x - from.x;
  return abs(vec2(paint, to.y - from.y - paint));
}

// How much the steps before and after a pixel, along d, are paint (1) or light (-1): of the larger one, for an edge within a network
// pixel shows in either.
float paint_along(ivec2 at, vec2 here, ivec2 d) {
  vec2 before = step_between(seen_at(at - d), here), after = step_between(here, seen_at(at + d));
  vec2 larger = before.x + before.y > after.x + after.y ? before : after;
  return (larger.x - larger.y) / (larger.x + larger.y + kEven);
}

void main() {
  ivec2 position = ivec2(grid_position(uint(push.network.x)));
  if (position.y >= push.network.y) return;
  vec2 here = seen_at(position);
  bool known = here.x != kUnknown;
  float right = known ? kEdge * paint_along(position, here, ivec2(1, 0)) : 0.0;
  float down = known ? kEdge * paint_along(position, here, ivec2(0, 1)) : 0.0;
  uint to = uint(FIELDS_STRIDE * (position.y * push.network.x + position.x));
  STORE(fields, to + FIELDS_EDGES, vec4(-right, right, -down, down));
  STORE(fields, to + FIELDS_CUES, vec4(0.0));
  float value = clamp(-here.x - mean_guide(position).w, -kReach, kReach);
  STORE(fields, to + FIELDS_CELL, known ? vec4(kTrust, value, -kTrust, 0.0) : vec4(0.0));
}
