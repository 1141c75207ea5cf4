// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "ground.glsl"

// Composes an object and its shadow over a frame, in linear light. The shadow is black with the missing light as its
// opacity.
PLANE_IN(0, picture);    // of the object's window: RGB times coverage, coverage
PLANE_IN(1, occlusion);
PLANE_INOUT(2, frame);   // RGB, alpha
layout(push_constant) uniform Push {
  ivec2 origin, size;         // of what is to do, in the frame
  ivec2 window, window_size;  // of the object's picture
  uint stride;                // pixels a row of the frame
  float center_x, center_y;   // of the object
  float radius;               // pixels
  float ground;               // height of the ground as it is seen, in radii from the center up
  float sine;                 // of the camera's elevation
  float turn_x, turn_y;       // cosine and sine of the object's yaw
  float strength;
} push;

float shadow(vec2 at) {
  vec2 seen = (at - vec2(push.center_x, push.center_y)) / push.radius;  // y down
  float near = (push.ground + seen.y) / push.sine;                      // towards the camera, along the ground
  vec2 own = vec2(push.turn_x * seen.x - push.turn_y * near, push.turn_y * seen.x + push.turn_x * near);
  vec2 on_grid = (own + kReach) * kPerUnit - 0.5;
  bool inside = all(greaterThan(on_grid, vec2(0.0))) && all(lessThan(on_grid, vec2(float(kOcclusion) - 1.001)));
  on_grid = clamp(on_grid, vec2(0.0), vec2(float(kOcclusion) - 1.001));
  ivec2 cell = ivec2(on_grid);
  vec2 f = on_grid - vec2(cell);
  int i = cell.y * kOcclusion + cell.x;
  float top = mix(FETCH(occlusion, i).x, FETCH(occlusion, i + 1).x, f.x);
  float bottom = mix(FETCH(occlusion, i + kOcclusion).x, FETCH(occlusion, i + kOcclusion + 1).x, f.x);
  // Without a shadow the grid is undefined.
  return inside && push.strength > 0.0 ? push.strength * mix(top, bottom, f.y) : 0.0;
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  at += push.origin;
  ivec2 own = at - push.window;
  bool drawn = all(greaterThanEqual(own, ivec2(0))) && all(lessThan(own, push.window_size));
  vec4 object = FETCH(picture, drawn ? own.y * push.window_size.x + own.x : 0);
  object = drawn ? object : vec4(0.0);
  float dark = shadow(vec2(at) + 0.5);
  uint i = uint(at.y) * push.stride + uint(at.x);
  vec4 below = LOAD(frame, i);
  float alpha = object.a + (1.0 - object.a) * (dark + below.a * (1.0 - dark));
  vec3 color = object.rgb + (1.0 - object.a) * below.a * (1.0 - dark) * below.rgb;
  bool touched = object.a > 0.0 || dark > 0.0;  // what is not keeps every bit
  STORE(frame, i, touched ? vec4(color / max(alpha, 1e-6), alpha) : below);
}
