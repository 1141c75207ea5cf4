#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"

// To the next coarser level: the residual of 2 x 2 pixels adds up to a coarse pixel's right-hand side, their masses to its
// mass, and the edges between two such aggregates to their edge, scaled by `scale` (sums alone make a piecewise
// constant correction half as long as it should be; see multigrid.hpp). One coarse quad an invocation.
PLANE_IN(0, system);
PLANE_IN(1, now);
PLANE_OUT(2, coarse_system);
PLANE_OUT(3, coarse);
layout(push_constant) uniform Push {
  uvec2 size;  // of the fine level
  float scale;
} push;

#define PAIRS(a, b) vec4((a).x + (a).y, (a).z + (a).w, (b).x + (b).y, (b).z + (b).w)

void main() {
  uvec2 half_size = (push.size + 1u) / 2u;
  uint quads = QUADS(push.size.x), half_quads = QUADS(half_size.x);
  uvec2 position = grid_position(half_quads);
  uint x = position.x, y = position.y;
  if (y >= half_size.y) return;
  int second = 2u * x + 1u < quads ? 1 : 0, next = int(min(2u * x + 2u, quads - 1u) - 2u * x);
  int before = x > 0u ? -1 : 0;
  float has_left = x > 0u ? 1.0 : 0.0, has_second = float(second);
  uint last = min(2u * y + 1u, push.size.y - 1u);
  vec4 rhs_sum = vec4(0.0), mass_sum = vec4(0.0), right_sum = vec4(0.0), down_sum = vec4(0.0);
  for (uint row = 2u * y; row <= last; ++row) {
    int at = int(row * quads + 2u * x);
    vec4 ua = FETCH(now, at), ub = FETCH(now, at + second);
    vec4 ra = FETCH(system, SYSTEM_STRIDE * at + SYSTEM_RIGHT);
    vec4 rb = has_second * FETCH(system, SYSTEM_STRIDE * (at + second) + SYSTEM_RIGHT);
    vec4 flow_a = ra * (SHIFT_LEFT(ua, ub) - ua), flow_b = rb * (SHIFT_LEFT(ub, FETCH(now, at + next)) - ub);
    float left = has_left * FETCH(system, SYSTEM_STRIDE * (at + before) + SYSTEM_RIGHT).w *
                 (ua.x - FETCH(now, at + before).w);
    vec4 ma = FETCH(system, SYSTEM_STRIDE * at + SYSTEM_MASS);
    vec4 mb = has_second * FETCH(system, SYSTEM_STRIDE * (at + second) + SYSTEM_MASS);
    vec4 a = FETCH(system, SYSTEM_STRIDE * at + SYSTEM_RHS) + flow_a - SHIFT_RIGHT(flow_a, vec4(left)) - ma * ua;
    vec4 b = has_second * FETCH(system, SYSTEM_STRIDE * (at + second) + SYSTEM_RHS) + flow_b -
             SHIFT_RIGHT(flow_b, flow_a) - mb * ub;
    if (row > 0u) {
      int up = at - int(quads);
      a += FETCH(system, SYSTEM_STRIDE * up + SYSTEM_DOWN) * (FETCH(now, up) - ua);
      b += has_second * FETCH(system, SYSTEM_STRIDE * (up + second) + SYSTEM_DOWN) * (FETCH(now, up + second) - ub);
    }
    int down = at + (row + 1u < push.size.y ? int(quads) : 0);
    vec4 da = FETCH(system, SYSTEM_STRIDE * at + SYSTEM_DOWN);
    vec4 db = has_second * FETCH(system, SYSTEM_STRIDE * (at + second) + SYSTEM_DOWN);
    a += da * (FETCH(now, down) - ua);
    b += db * (FETCH(now, down + second) - ub);
    rhs_sum += PAIRS(a, b);
    mass_sum += PAIRS(ma, mb);
    right_sum += vec4(ra.yw, rb.yw);
    down_sum = PAIRS(da, db);  // of the lower row in the end
  }
  uint to = y * half_quads + x;
  STORE(coarse_system, SYSTEM_STRIDE * to + SYSTEM_RIGHT, push.scale * right_sum);
  STORE(coarse_system, SYSTEM_STRIDE * to + SYSTEM_DOWN, push.scale * down_sum);
  STORE(coarse_system, SYSTEM_STRIDE * to + SYSTEM_MASS, mass_sum);
  STORE(coarse_system, SYSTEM_STRIDE * to + SYSTEM_RHS, rhs_sum);
  STORE(coarse, to, vec4(0.0));
}
