// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "global/model/model.glsl"

// The points of the grid: mean color and its weight, its log chroma, and an estimate of the mean shading of its pixels, with and
// without the history. One point a workgroup.
layout(constant_id = 1) const bool kRaw = false;   // as the lamps color it
layout(constant_id = 2) const bool kPlain = false;  // colors alone, of lamps that are white
PLANE_IN(0, frame);
SCALAR_IN(1, memory);  // mean ln R
PLANE_IN(2, scene);
PLANE_IN(3, light_state);  // light.glsl
PLANE_OUT(4, colors);  // rgb; weight
PLANE_OUT(5, points);  // chroma; shading as before, and as guessed
layout(push_constant) uniform Push {
  SIZES
  float white_level;
} push;

const float kDark = 0.01, kBright = 0.98;  // range of reliable colors

void main() {
  int i = int(line_index() / gl_WorkGroupSize.x);
  if (i >= push.grid.x * push.grid.y) return;
  ivec2 first = push.factor * ivec2(i % push.grid.x, i / push.grid.x), last = min(first + push.factor, push.size);
  vec3 white = kRaw || kPlain ? vec3(1.0) : color_of(FETCH(scene, SCENE_WHITE).xy);
  vec4 sum = vec4(0.0), now = FETCH(light_state, LIGHT_NOW);
  float guessed = 0.0;
  for (int y = first.y + int(gl_LocalInvocationID.x / 8u); y < last.y; y += int(gl_WorkGroupSize.x / 8u))
    for (int x = first.x + int(gl_LocalInvocationID.x % 8u); x < last.x; x += 8) {
      int n = y * push.size.x + x;
      vec3 rgb = in_white_light(sanitize(FETCH(frame, n).rgb) / white, now);
      sum.rgb += rgb;
      if (kPlain) continue;
      sum.w += shading_before(rgb, FETCH1(memory, n));
      guessed += shading_guessed(rgb, push.white_level);
    }
  float share = 1.0 / float((last.x - first.x) * (last.y - first.y));
  sum = share * workgroup_sum(sum);
  if (!kPlain) guessed = workgroup_sum(vec4(guessed)).x;
  if (gl_LocalInvocationID.x > 0u) return;
  float mean = mean3(sum.rgb);
  bool fair = mean > kDark && max(max(sum.r, sum.g), sum.b) < kBright;
  STORE(colors, i, vec4(sum.rgb, fair ? mean : 0.0));
  STORE(points, i, vec4(chroma_of(sum.rgb), sum.w, share * guessed));
}
