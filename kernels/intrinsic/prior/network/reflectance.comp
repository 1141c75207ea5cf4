// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "intrinsic/guide/guide.glsl"

// The fields of fields.glsl from a network that estimates reflectance: what it leaves of the picture is the target of shading. One pixel of the network's picture an invocation.
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

const float kTrust = 1.5;                       // change of ln v and ln g
const float kDarkest = 1e-3, kBrightest = 1e3;  // reflectance
const float kReach = 6.0;                       // of V

void main() {
  ivec2 position = ivec2(grid_position(uint(push.network.x)));
  if (position.y >= push.network.y) return;
  vec3 r = FETCH(reflectance, 1 + position.y * push.padded_width + position.x).rgb;
  bool wrong = any(greaterThan(floatBitsToInt(r) & ivec3(0x7fffffff), ivec3(0x7f800000)));  // NaN
  vec3 logs = log(clamp(r, kDarkest, kBrightest));
  float value = clamp(-(logs.r + logs.g + logs.b) / 3.0 - mean_guide(position).w, -kReach, kReach);
  STORE(fields, position.y * push.network.x + position.x, wrong ? vec4(0.0) : vec4(kTrust, value, -kTrust, 0.0));
}
