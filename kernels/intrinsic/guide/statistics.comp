// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "guide.glsl"
#include "image/pack4.glsl"

// The sums behind the frame's statistics, over the cells of level 1 and their steps to the right and down. A strip of
// kRows cells an invocation. Dark cells are trusted little.
layout(constant_id = 1) const uint kRows = 8;
PLANE_IN(0, level);
PLANE_OUT(1, intensity_sums);  // sum t, sum t m, sum t u, -
PLANE_OUT(2, chromatic_sums);  // sum w dv, sum 0.1 w / (0.1 + dv), sum w, -
PLANE_OUT(3, plain_sums);      // sum a min(|dm|, 1), sum a, -, -
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 1

vec4 intensity = vec4(0.0), chromatic = vec4(0.0), plain = vec4(0.0);

float trust(float m) {
  float light = exp(m);
  return light / (light + 0.02);
}

void count(vec4 step, float both) {
  float dc = min(length(step.yz), 0.3), dv = abs(step.x + step.w), w = both * dc * dc;
  chromatic.xyz += vec3(w * dv, 0.1 * w / (0.1 + dv), w);
  float even = both * 0.05 / (0.05 + dc);
  plain.xy += vec2(even * min(abs(step.x), 1.0), even);
}

void main() {
  uvec2 position = grid_position(push.size.x);
  uint first = position.y * kRows, last = min(first + kRows, push.size.y);
  if (first < push.size.y) {
    int at = int(first * push.size.x + position.x), next = position.x + 1u < push.size.x ? 1 : 0;
    vec4 here = FETCH(level, at);
    float t = trust(here.x);
    for (uint y = first; y < last; ++y) {
      intensity.xyz += t * vec3(1.0, here.xw);
      vec4 right = FETCH(level, at + next);
      count(here - right, float(next) * t * trust(right.x));
      bool ends = y + 1u == push.size.y;
      at += ends ? 0 : int(push.size.x);
      vec4 below = FETCH(level, at);
      float t_below = trust(below.x);
      count(here - below, ends ? 0.0 : t * t_below);
      here = below;
      t = t_below;
    }
  }
  SUM_PARTIALS(intensity_sums, intensity);
  SUM_PARTIALS(chromatic_sums, chromatic);
  SUM_PARTIALS(plain_sums, plain);
}
