// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/guide/guide.glsl"

// Distance of two decompositions of a frame: sums over pixels of w, w d and w d^2, d the difference of log shading and w the weight
// of the pixel, low for dark ones, which show neither layer. A strip of kRows pixels an invocation.
layout(constant_id = 1) const uint kRows = 8;
PLANE_IN(0, frame);
PLANE_IN(1, one);    // R.rgb, S
PLANE_IN(2, other);
PLANE_OUT(3, sums);
layout(push_constant) uniform Push { uvec2 size; } push;

const float kLittleLight = 0.02;
const float kMinShading = 1e-20;

void main() {
  uint i = line_index(), x = i % push.size.x, first = i / push.size.x * kRows;
  vec3 sum = vec3(0.0);
  for (uint y = first; y < min(first + kRows, push.size.y); ++y) {
    int at = int(y * push.size.x + x);
    vec3 rgb = sanitize(FETCH(frame, at).rgb);
    float light = (rgb.r + rgb.g + rgb.b) / 3.0, w = light / (light + kLittleLight);
    float d = log(max(FETCH(one, at).w, kMinShading) / max(FETCH(other, at).w, kMinShading));
    sum += w * vec3(1.0, d, d * d);
  }
  SUM_PARTIALS(sums, vec4(sum, 0.0));
}
