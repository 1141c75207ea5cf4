#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "relax.glsl"

// Half a block Gauss-Seidel pass, in place: the grid is a checkerboard of blocks of 4 x 4 pixels, and a pass over each
// color makes one step. An invocation improves one block with its surroundings fixed: rows are solved exactly,
// downwards and back upwards. Invocations read and write disjoint blocks, so the order does not matter.
PLANE_IN(0, system);
PLANE_IN(1, now);
PLANE_OUT(2, improved);  // the same buffer
layout(push_constant) uniform Push {
  uvec2 size;
  uint color;
} push;

#define SOLVE_ROW(k, up, down) \
  u[k] = solve_quad(diagonal[k], right[k], rhs[k] + fall[k] * (up) + fall[k + 1] * (down))

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position((quads + 1u) / 2u);
  uint x = 2u * position.x + ((position.y + push.color) & 1u), first = 4u * position.y;
  if (x >= quads || first >= push.size.y) return;
  int next = int(min(x + 1u, quads - 1u)) - int(x), before = x > 0u ? -1 : 0;
  float has_left = x > 0u ? 1.0 : 0.0;
  int at = int(first * quads + x);
  vec4 u[4], right[4], rhs[4], diagonal[4], fall[5];
  int up = first > 0u ? at - int(quads) : at;
  vec4 above = FETCH(now, up);
  fall[0] = first > 0u ? FETCH(system, SYSTEM_STRIDE * up + SYSTEM_DOWN) : vec4(0.0);
  [[unroll]] for (uint k = 0u; k < 4u; ++k) {
    int row = at + int(min(k, push.size.y - 1u - first) * quads);  // rows below the frame repeat the last, unused
    u[k] = FETCH(now, row);
    right[k] = FETCH(system, SYSTEM_STRIDE * row + SYSTEM_RIGHT);
    fall[k + 1u] = FETCH(system, SYSTEM_STRIDE * row + SYSTEM_DOWN);
    float left = has_left * FETCH(system, SYSTEM_STRIDE * (row + before) + SYSTEM_RIGHT).w;
    diagonal[k] = FETCH(system, SYSTEM_STRIDE * row + SYSTEM_MASS) + right[k] + SHIFT_RIGHT(right[k], vec4(left)) +
                  fall[k] + fall[k + 1u];
    rhs[k] = FETCH(system, SYSTEM_STRIDE * row + SYSTEM_RHS);
    rhs[k].x += left * FETCH(now, row + before).w;
    rhs[k].w += right[k].w * FETCH(now, row + next).x;
  }
  vec4 below = FETCH(now, at + int(min(4u, push.size.y - 1u - first) * quads));
  SOLVE_ROW(0, above, u[1]);
  SOLVE_ROW(1, u[0], u[2]);
  SOLVE_ROW(2, u[1], u[3]);
  SOLVE_ROW(3, u[2], below);
  SOLVE_ROW(2, u[1], u[3]);
  SOLVE_ROW(1, u[0], u[2]);
  SOLVE_ROW(0, above, u[1]);
  [[unroll]] for (uint k = 0u; k < 4u; ++k)
    if (first + k < push.size.y) STORE(improved, at + int(k * quads), u[k]);
}
