// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/guide/guide.glsl"
#include "image/light_color.glsl"
#include "image/pack4.glsl"
#include "upsample.glsl"

// The frame's layers: lines averaged over 3 x 3, interpolated to the pixels, and read at their m. One half-size pixel, up to
// 2 x 2 pixels, an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, lines);
PLANE_OUT(2, intrinsic);
PLANE_IN(3, slope);  // with kColored
layout(constant_id = 1) const bool kColored = false;
layout(push_constant) uniform Push {
  uvec2 size;  // of the frame
  uint first_row;
} push;

// A left or upper pixel is a quarter of a half-size pixel before the center: of the means of three around it, 1/4 of the one
// before and 3/4 of its own. A right or lower pixel has the mirror image.
float tap(int d) { return d == 2 ? 0.0 : d == 1 ? 3.0 / 12.0 : d == -2 ? 1.0 / 12.0 : 4.0 / 12.0; }

void main() {
  uvec2 half_size = (push.size + 1u) / 2u, at = grid_position(half_size.x) + uvec2(0u, push.first_row / 2u);
  if (at.y >= half_size.y) return;
  vec2 part[2][2] = vec2[2][2](vec2[2](vec2(0.0), vec2(0.0)), vec2[2](vec2(0.0), vec2(0.0)));
  for (int dy = -2; dy <= 2; ++dy) {
    int row = clamp(int(at.y) + dy, 0, int(half_size.y) - 1) * int(half_size.x);
    vec2 left = vec2(0.0), right = vec2(0.0);
    for (int dx = -2; dx <= 2; ++dx) {
      vec2 line = FETCH(lines, row + clamp(int(at.x) + dx, 0, int(half_size.x) - 1)).xy;
      left += tap(dx) * line;
      right += tap(-dx) * line;
    }
    part[0][0] += tap(dy) * left;
    part[0][1] += tap(dy) * right;
    part[1][0] += tap(-dy) * left;
    part[1][1] += tap(-dy) * right;
  }
  for (uint k = 0u; k < 4u; ++k) {
    uvec2 to = 2u * at + uvec2(k & 1u, k >> 1u);
    if (to.x >= push.size.x || to.y >= push.size.y) continue;
    uint pixel = to.y * push.size.x + to.x;
    vec3 rgb = sanitize(FETCH(frame, int(pixel)).rgb);
    vec2 line = part[k >> 1u][k & 1u];
    float s = line.x * mean_log(rgb) + line.y;
    float light = exp(s);
    rgb = kColored ? reflectance_in(rgb, light, FETCH(slope, 0)[SLOPE_K], s - FETCH(slope, 0)[SLOPE_WHITE]) : rgb * exp(-s);
    STORE(intrinsic, BY_ROWS(pixel), vec4(rgb, light));
  }
}
