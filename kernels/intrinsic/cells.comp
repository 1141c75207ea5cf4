#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "../gpu/common.glsl"
#include "guide.glsl"
#include "quad.glsl"

// The guide's level 2 from its level 0: means over 4 x 4 pixels, and how active they are. One cell an invocation.
PLANE_IN(0, fine);
PLANE_OUT(1, cells);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 0

ivec2 last = ivec2(push.size) - 1;

vec4 pixel(int x, int y) { return FETCH(fine, min(y, last.y) * int(push.size.x) + min(x, last.x)); }

void main() {
  uvec2 half_size = (push.size + 1u) / 2u, cell_size = (half_size + 1u) / 2u, cell = grid_position(cell_size.x);
  if (cell.y >= cell_size.y) return;
  ivec2 first = ivec2(4u * cell);
  uvec2 count = min(push.size - 4u * cell, uvec2(4u));
  vec4 columns = cell_weights(count.x), rows = cell_weights(count.y), sum = vec4(0.0);
  vec2 activity = vec2(0.0);
  vec4 here[4];
  [[unroll]] for (int x = 0; x < 4; ++x) here[x] = pixel(first.x + x, first.y);
  for (int y = 0; y < 4; ++y) {
    vec4 beside = pixel(first.x + 4, first.y + y);
    [[unroll]] for (int x = 0; x < 4; ++x) {
      vec4 below = pixel(first.x + x, first.y + y + 1), right = here[x] - (x < 3 ? here[min(x + 1, 3)] : beside);
      vec4 down = here[x] - below;
      float share = rows.x * columns[x];
      sum += share * here[x];
      activity += share * vec2(abs(right.x) + abs(down.x), length(right.yz) + length(down.yz));
      here[x] = below;
    }
    rows = rows.yzwx;
  }
  uint to = CELL_STRIDE * (cell.y * cell_size.x + cell.x);
  STORE(cells, to, sum);
  STORE(cells, to + 1u, vec4(activity, 0.0, 0.0));
}
