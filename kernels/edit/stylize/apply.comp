// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit/edit.glsl"
#include "stylize.glsl"

// Draws a frame: shading in levels, dark lines where it has edges, flat reflectance.
//
//   E1, E2 = shading (stylize.glsl) blurred by Gaussians of sigma and kRatio sigma
//   t      = (E2 - E1) / kStepResponse: the height of a step of shading, stops, seen from its dark side
//   line   = tanh(sharpness max(sensitivity t - 1, 0))
//   e      = E1 + edge(|E - E1|) (E - E1): blurred but for edges, beside which levels in between would show as rims
//   S'     = S + w ((1 - line) level(e) - S)        R' = R + w (flat R - R)        w = strength matte
layout(constant_id = 1) const bool MATTE = false;
layout(constant_id = 2) const bool SHADES = false;     // lines or levels
layout(constant_id = 3) const bool FLATTENED = false;
PLANE_IN(0, intrinsic);
PLANE_IN(1, mask);
PLANE_IN(2, flattened);
SCALAR_IN(3, near);  // E1 and E2, of cells
SCALAR_IN(4, wide);
PLANE_OUT(5, edited);
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 grid;   // in cells
  float cells;  // a pixel
  float sensitivity;
  float sharpness;
  float levels;
  float softness;
  float strength;
  uint first_row;
} push;

const float kStepResponse = 0.111678;  // most that the difference of Gaussians answers to a step of 1
const float kEdgeFrom = 0.25, kEdgeTo = 0.75;  // stops
const float kMaxSlope = 15.0;          // tanh is 1 beyond

// Between cells, whose centers are halfway.
vec2 blurred_at(uvec2 pixel) {
  vec2 place = clamp((vec2(pixel) + 0.5) * push.cells - 0.5, vec2(0.0), vec2(push.grid - 1u));
  ivec2 low = ivec2(place), high = min(low + 1, ivec2(push.grid) - 1);
  vec2 t = place - vec2(low);
  int row = low.y * int(push.grid.x), next = high.y * int(push.grid.x);
  vec2 above = mix(vec2(FETCH1(near, row + low.x), FETCH1(wide, row + low.x)),
                   vec2(FETCH1(near, row + high.x), FETCH1(wide, row + high.x)), t.x);
  vec2 below = mix(vec2(FETCH1(near, next + low.x), FETCH1(wide, next + low.x)),
                   vec2(FETCH1(near, next + high.x), FETCH1(wide, next + high.x)), t.x);
  return mix(above, below, t.y);
}

float without_rims(float e, float blurred) {
  float t = clamp((abs(e - blurred) - kEdgeFrom) / (kEdgeTo - kEdgeFrom), 0.0, 1.0);
  return blurred + t * t * (3.0 - 2.0 * t) * (e - blurred);
}

// The nearest of levels that are kWhite / levels apart. From one to the next it takes the share `softness` of the way.
float level_of(float e) {
  float place = e * push.levels / kWhite, lower = floor(place);
  float t = clamp((place - lower - 0.5) / max(push.softness, 1e-3) + 0.5, 0.0, 1.0);
  return decoded((lower + t * t * (3.0 - 2.0 * t)) * kWhite / push.levels);
}

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec4 layers = finite(FETCH(intrinsic, n)), drawn = layers;
    if (FLATTENED) drawn.rgb = FETCH(flattened, n).rgb;
    if (SHADES) {
      vec2 e = blurred_at(uvec2(at.x, y));
      if (push.levels > 0.0) drawn.w = level_of(without_rims(encoded(layers.w), e.x));
      float above = push.sensitivity * (e.y - e.x) / kStepResponse - 1.0;
      drawn.w *= 2.0 / (1.0 + exp(2.0 * min(push.sharpness * max(above, 0.0), kMaxSlope)));  // 1 - tanh
    }
    float w = push.strength * (MATTE ? min(finite(FETCH(mask, n)).x, 1.0) : 1.0);
    STORE(edited, BY_ROWS(n), min(mix(layers, drawn, w), vec4(kLargest)));
  }
}
