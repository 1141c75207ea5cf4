// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/guide/guide.glsl"
#include "image/pack4.glsl"
#include "upsample.glsl"

// Samples for the fit of the lines: (mean m of the up to 2 x 2 pixels, log shading). One half-size pixel an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, intrinsic);  // of the half-size frame: R.rgb, S
PLANE_OUT(2, samples);
layout(push_constant) uniform Push {
  uvec2 frame_size, size;  // size: of the half-size frame
  uint first_row;
} push;

void main() {
  uvec2 at = grid_position(push.size.x) + uvec2(0u, push.first_row);
  if (at.y >= push.size.y) return;
  float sum = 0.0;
  for (uint k = 0u; k < 4u; ++k) {
    uvec2 from = min(2u * at + uvec2(k & 1u, k >> 1u), push.frame_size - 1u);
    sum += mean_log(sanitize(FETCH(frame, int(from.y * push.frame_size.x + from.x)).rgb));
  }
  uint pixel = at.y * push.size.x + at.x;
  STORE(samples, BY_ROWS(pixel), vec4(0.25 * sum, max(log(FETCH(intrinsic, int(pixel)).w), kDarkest), 0.0, 0.0));
}
