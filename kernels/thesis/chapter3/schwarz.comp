// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "gpu/workgroup_sum.glsl"

// One additive Schwarz iteration (3.5.2): a workgroup of 64 solves one 16x16 block by conjugate gradients, every
// invocation a vertical strip of four pixels. Values outside the block stay as they were before the iteration: they are
// part of the residual that the solve starts from, and the directions are zero there.
PLANE_IN(0, solution);
PLANE_IN(1, preconditioned);
PLANE_IN(2, edges);
PLANE_IN(3, nodes);
PLANE_OUT(4, result);
#define STROKE_BINDING 5
#include "thesis/chapter4/strokes.glsl"

const int kStrip = 4;
const int kPitch = 18;
shared vec4 directions[kPitch * kPitch];  // of the block, with a border of zeros

void main() {
  int lane = int(gl_LocalInvocationID.x);
  ivec2 corner = ivec2(gl_WorkGroupID.xy) * 16 - push.shift;
  ivec2 local = ivec2(lane % 16, lane / 16 * kStrip);
  for (int i = lane; i < kPitch * kPitch; i += 64) directions[i] = vec4(0.0);
  barrier();

  int column = corner.x + local.x;
  bool has_column = column >= 0 && column < push.size.x;
  float held[kStrip];  // U
  vec4 x[kStrip], z[kStrip], d[kStrip], node[kStrip], diag[kStrip], to_next[kStrip];  // to_next: a and V right, left
  vec2 down[kStrip + 1];                                                             // a and V across each row
  float rz = 0.0;
  int base = clamp(column, 0, push.size.x - 1);
  int above = corner.y + local.y - 1;
  down[0] = (above >= 0 ? 1.0 : 0.0) * FETCH(edges, clamp(above, 0, push.size.y - 1) * push.size.x + base).yw;
  for (int k = 0; k < kStrip; ++k) {
    int row = corner.y + local.y + k;
    float live = has_column && row >= 0 && row < push.size.y ? 1.0 : 0.0;
    int n = clamp(row, 0, push.size.y - 1) * push.size.x + base;
    vec4 edge = FETCH(edges, n);
    to_next[k] = vec4(edge.xz, (base > 0 ? 1.0 : 0.0) * FETCH(edges, n - (base > 0 ? 1 : 0)).xz);
    down[k + 1] = (row >= 0 ? 1.0 : 0.0) * edge.yw;  // no edge from above the frame
    node[k] = live * FETCH(nodes, n);
    held[k] = live * shading_weight(base, clamp(row, 0, push.size.y - 1));
    x[k] = FETCH(solution, n);
    z[k] = live * FETCH(preconditioned, n);
    d[k] = z[k];
    diag[k] = diagonal(node[k]);
    rz += dot(z[k], diag[k] * z[k]);
  }
  rz = workgroup_sum(vec4(rz)).x;

  int here = (local.y + 1) * kPitch + local.x + 1;
  for (int iteration = 0; iteration < push.count; ++iteration) {
    for (int k = 0; k < kStrip; ++k) directions[here + k * kPitch] = d[k];
    barrier();
    vec4 q[kStrip];
    vec2 curvature = vec2(0.0);  // dᵀA d, dᵀM d
    for (int k = 0; k < kStrip; ++k) {
      int at = here + k * kPitch;
      q[k] = apply_node(node[k], held[k], d[k]) + to_next[k].xxxy * (d[k] - directions[at + 1]) +
             to_next[k].zzzw * (d[k] - directions[at - 1]) + down[k].xxxy * (d[k] - directions[at - kPitch]) +
             down[k + 1].xxxy * (d[k] - directions[at + kPitch]);
      curvature += vec2(dot(d[k], q[k]), dot(d[k], diag[k] * d[k]));
    }
    curvature = workgroup_sum(vec4(curvature, 0.0, 0.0)).xy;
    float alpha = curves(curvature) && rz > 0.0 ? rz / curvature.x : 0.0;
    float next = 0.0;
    for (int k = 0; k < kStrip; ++k) {
      x[k] += alpha * d[k];
      z[k] -= alpha * precondition(diag[k], q[k]);
      next += dot(z[k], diag[k] * z[k]);
    }
    next = workgroup_sum(vec4(next)).x;
    float beta = alpha > 0.0 ? next / rz : 0.0;
    rz = alpha > 0.0 ? next : 0.0;
    for (int k = 0; k < kStrip; ++k) d[k] = z[k] + beta * d[k];
  }

  for (int k = 0; k < kStrip; ++k) {
    int row = corner.y + local.y + k;
    if (has_column && row >= 0 && row < push.size.y) STORE(result, row * push.size.x + column, x[k]);
  }
}
