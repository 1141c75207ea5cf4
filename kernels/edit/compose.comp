// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit.glsl"
#include "image/light_color.glsl"

// Recombines a frame from its layers: old = R S L of the decomposer, new = R' S' L' after edits. L, the color of light,
// is the product of a layer (LIGHT) and of what follows from S (SLOPE).
layout(constant_id = 1) const uint MODE = 0u;
layout(constant_id = 2) const bool LIGHT = false;
layout(constant_id = 3) const bool SLOPE = false;
const uint kAdd = 0u;         // input + new − old: keeps the residual of the model
const uint kRatio = 1u;       // input · (new + ε) / (old + ε): scales it with the edit
const uint kNone = 2u;        // new: drops it
const uint kDifference = 3u;  // (new − old) / 2 on middle gray
const uint kMask = 4u;        // the mask layer as gray

PLANE_IN(0, frame);  // linear RGB, alpha
PLANE_IN(1, model);
PLANE_IN(2, intrinsic);  // kMask: the mask layer
PLANE_IN(3, model_light);
PLANE_IN(4, light);
PLANE_IN(5, slope);
PLANE_OUT(6, picture);
layout(push_constant) uniform Push {
  uvec2 size;
  float strength;  // 0: the input, 1: the edit
  uint first_row;
} push;

const float kRatioFloor = 2e-3;     // linear light, 1 = full scale

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec4 seen = finite(FETCH(frame, n));
    vec4 before = finite(FETCH(model, n));
    vec4 now = finite(FETCH(intrinsic, n));
    vec3 from = before.rgb * (SLOPE ? colored_light(FETCH(slope, 0), before.w) : before.www);
    vec3 to = now.rgb * (SLOPE ? colored_light(FETCH(slope, 0), now.w) : now.www);
    bool same = now == before;
    if (LIGHT) {
      vec3 was = finite(FETCH(model_light, n)).rgb, is = finite(FETCH(light, n)).rgb;
      same = same && is == was;
      from *= was;
      to *= is;
    }
    vec3 edited = MODE == kMask         ? now.xxx
                  : MODE == kDifference ? kMiddleGray + 0.5 * (to - from)
                  : MODE == kNone       ? to
                  : MODE == kRatio      ? seen.rgb * ((to + kRatioFloor) / (from + kRatioFloor))
                                        : seen.rgb + (to - from);
    // Both products may be rounded in different ways: what was not edited is taken as it came.
    vec3 drawn = MODE >= kDifference                ? edited
                 : same && MODE != kNone ? seen.rgb
                                         : seen.rgb + push.strength * (edited - seen.rgb);
    STORE(picture, BY_ROWS(n), vec4(clamp(drawn, vec3(0.0), vec3(kLargest)), min(seen.w, 1.0)));
  }
}
