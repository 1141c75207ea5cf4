#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "relax.glsl"

// Half a block Gauss-Seidel pass, in place: the grid is a checkerboard of blocks of 4 x 4 pixels, and a pass over each
// color makes one step. An invocation improves one block with its surroundings fixed: rows are solved exactly, downwards
// and back upwards. Invocations read and write disjoint blocks, so their order does not matter.
//
// With kCorrect, the first pass after a coarser level: adds the correction of that level's 2 x 2 aggregates, to the
// block and to what it reads around it where push.around says that those blocks have not been corrected yet.
layout(constant_id = 1) const int kStride = 4;  // of the system: 4, or 3 without a plane of masses
layout(constant_id = 2) const bool kCorrect = false;
PLANE_IN(0, system);
PLANE_IN(1, now);
PLANE_IN(2, coarse);
PLANE_OUT(3, improved);  // the same buffer as `now`
layout(push_constant) uniform Push {
  uvec2 size;
  uint color;
  float mass;    // of every pixel where there is no plane of masses
  float around;  // 1 or 0
} push;

int quads = int(QUADS(push.size.x)), coarse_quads = int(QUADS((push.size.x + 1u) / 2u));

vec4 corrected(int x, int y, float share) {
  vec4 value = FETCH(now, y * quads + x);
  if (kCorrect) {
    vec4 pairs = FETCH(coarse, (y >> 1) * coarse_quads + (x >> 1));
    value += share * ((x & 1) == 0 ? pairs.xxyy : pairs.zzww);
  }
  return value;
}

#define SOLVE_ROW(k, up, down) \
  u[k] = solve_quad(diagonal[k], right[k], rhs[k] + fall[k] * (up) + fall[k + 1] * (down))

void main() {
  ivec2 position = ivec2(grid_position(uint(quads + 1) / 2u)), last = ivec2(quads, push.size.y) - 1;
  int x = 2 * position.x + ((position.y + int(push.color)) & 1), first = 4 * position.y;
  if (x > last.x || first > last.y) return;
  int next = min(x + 1, last.x), before = max(x - 1, 0), top = max(first - 1, 0);
  float has_left = x > 0 ? 1.0 : 0.0;
  vec4 u[4], right[4], rhs[4], diagonal[4], fall[5];
  vec4 above = corrected(x, top, push.around), below = corrected(x, min(first + 4, last.y), push.around);
  fall[0] = (first > 0 ? 1.0 : 0.0) * FETCH(system, kStride * (top * quads + x) + SYSTEM_DOWN);
  [[unroll]] for (int k = 0; k < 4; ++k) {
    int y = min(first + k, last.y), at = kStride * (y * quads + x);  // rows below the frame repeat the last, unused
    u[k] = corrected(x, y, 1.0);
    right[k] = FETCH(system, at + SYSTEM_RIGHT);
    fall[k + 1] = FETCH(system, at + SYSTEM_DOWN);
    rhs[k] = FETCH(system, at + SYSTEM_RHS);
    float left = has_left * FETCH(system, kStride * (y * quads + before) + SYSTEM_RIGHT).w;
    diagonal[k] = (kStride > 3 ? FETCH(system, at + SYSTEM_MASS) : vec4(push.mass)) + right[k] +
                  SHIFT_RIGHT(right[k], vec4(left)) + fall[k] + fall[k + 1];
    rhs[k].x += left * corrected(before, y, push.around).w;
    rhs[k].w += right[k].w * corrected(next, y, push.around).x;
  }
  SOLVE_ROW(0, above, u[1]);
  SOLVE_ROW(1, u[0], u[2]);
  SOLVE_ROW(2, u[1], u[3]);
  SOLVE_ROW(3, u[2], below);
  SOLVE_ROW(2, u[1], u[3]);
  SOLVE_ROW(1, u[0], u[2]);
  SOLVE_ROW(0, above, u[1]);
  [[unroll]] for (int k = 0; k < 4; ++k)
    if (first + k <= last.y) STORE(improved, uint((first + k) * quads + x), u[k]);
}
