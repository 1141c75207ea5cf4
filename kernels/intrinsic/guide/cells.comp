// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gpu/common.glsl"
#include "guide.glsl"
#include "image/pack4.glsl"

// The guide's level 2 from its level 0: means over 4 x 4 pixels, and how active they are. One cell an invocation.
PLANE_IN(0, fine);
PLANE_OUT(1, cells);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 0

ivec2 last = ivec2(push.size) - 1;

vec4 pixel(int x, int y) {
  return FETCH(fine, clamp(y, 0, last.y) * int(push.size.x) + clamp(x, 0, last.x));
}

vec2 activity(vec4 step) { return vec2(abs(step.x), length(step.yz)); }

void main() {
  uvec2 half_size = (push.size + 1u) / 2u, cell_size = (half_size + 1u) / 2u, cell = grid_position(cell_size.x);
  if (cell.y >= cell_size.y) return;
  ivec2 first = ivec2(4u * cell);
  uvec2 count = min(push.size - 4u * cell, uvec2(4u));
  vec4 columns = cell_weights(count.x), rows = cell_weights(count.y), sum = vec4(0.0), here[4];
  vec2 steps = vec2(0.0), above[4];
  [[unroll]] for (int x = 0; x < 4; ++x) {
    here[x] = pixel(first.x + x, first.y);
    above[x] = activity(here[x] - pixel(first.x + x, first.y - 1));
  }
  for (int y = 0; y < 4; ++y) {
    vec4 beside = pixel(first.x + 4, first.y + y);
    vec2 left = activity(here[0] - pixel(first.x - 1, first.y + y));
    [[unroll]] for (int x = 0; x < 4; ++x) {
      vec4 below = pixel(first.x + x, first.y + y + 1);
      vec2 right = activity(here[x] - (x < 3 ? here[min(x + 1, 3)] : beside)), down = activity(here[x] - below);
      float share = rows.x * columns[x];
      sum += share * here[x];
      steps += 0.5 * share * (left + right + above[x] + down);
      left = right;
      above[x] = down;
      here[x] = below;
    }
    rows = rows.yzwx;
  }
  uint to = CELL_STRIDE * (cell.y * cell_size.x + cell.x);
  STORE(cells, to, sum);
  STORE(cells, to + 1u, vec4(steps, 0.0, 0.0));
}
