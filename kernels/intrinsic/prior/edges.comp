// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "intrinsic/guide/guide.glsl"

// EdgePrior, pixels: the weights of reflectance (a) and shading (b) of every edge, from local cues of the guide. An invocation
// has a block of 4 x 4 pixels and their edges to the right or, with kDown, down. Common terms are evaluated once: the surroundings
// on level 2 for up to twelve edges, those on level 1 for the two adjacent edges in the same cells, and along a row or column a
// pixel and a step for the edges before and after. Only the two adjacent edges are unrolled, so that the function is compiled
// twice and not sixteen times.
layout(constant_id = 1) const bool kDown = false;
PLANE_IN(0, level0);
PLANE_IN(1, level1);
PLANE_IN(2, cells);
PLANE_IN(3, statistics);
PLANE_IN(4, tuning);
PLANE_OUT(5, system);  // of stride 3
PLANE_OUT(6, flux);
#define TILE_CONSTANT 2
#define TILE_BINDING 7
#include "image/tiles/tile_position.glsl"
layout(push_constant) uniform Push {
  ivec2 size;
  float reflectance_weight;
  float shading_weight;
} push;
#include "edge_net.glsl"
#include "net.glsl"

// How much more the largest channel steps than the mean does.
float value_step(vec4 step) { return 5.0 * clamp(abs(step.x + step.w) - abs(step.x), -0.4, 0.4); }

ivec2 last = push.size - 1;

// Level 0, clamped to the border.
vec4 pixel(ivec2 at) {
  at = clamp(at, ivec2(0), last);
  return FETCH(level0, at.y * push.size.x + at.x);
}

void main() {
  int packs = int(PACK4(uint(push.size.x)));
  ivec2 block = ivec2(tile_position(uint(packs))) * 4;
  if (block.y > last.y) return;
  const ivec2 d = kDown ? ivec2(0, 1) : ivec2(1, 0);
  ivec2 size1 = (push.size + 1) / 2, size2 = (size1 + 1) / 2;
  float mean = FETCH(statistics, STATISTICS_MEAN).x;
  float f[EDGE_CUES];
  // Of the surroundings on level 2, which the first three columns (rows) share; the last has its own.
  vec4 far[EDGE_VECTORS], last_far[EDGE_VECTORS];
  for (int part = 0; part < 2; ++part) {
    far = last_far;
    ivec2 at = min(block + 3 * part * d, last), p = max(at - 3 * d, ivec2(0)) >> 2, q = min((at + 4 * d) >> 2, size2 - 1);
    int cell_p = CELL_STRIDE * (p.y * size2.x + p.x), cell_q = CELL_STRIDE * (q.y * size2.x + q.x);
    vec4 step = FETCH(cells, cell_p) - FETCH(cells, cell_q);
    vec4 activity = 0.5 * (FETCH(cells, cell_p + 1) + FETCH(cells, cell_q + 1));
    f[4] = cue(abs(step.x));
    f[5] = cue(length(step.yz));
    f[6] = cue(activity.x);
    f[7] = cue(activity.y);
    EDGE_BIASES(last_far);
    edge_stage0(f, last_far);
  }
  vec4 weights[4], fluxes[4];  // rows; those to the right are written as soon as two are complete
  for (int run = 0; run < 2; ++run) {  // two rows or columns side by side
    ivec2 start = block + 2 * run * d.yx;
    vec4 p[2], q[2];
    float before_m[2], before_c[2], here_m[2], here_c[2];  // sizes of the steps into p and from p to q
    [[unroll]] for (int side = 0; side < 2; ++side) {
      ivec2 at = start + side * d.yx;
      p[side] = pixel(at);
      q[side] = pixel(at + d);
      vec4 before = pixel(at - d) - p[side], here = p[side] - q[side];
      before_m[side] = abs(before.x);
      before_c[side] = length(before.yz);
      here_m[side] = abs(here.x);
      here_c[side] = length(here.yz);
    }
    for (int pair = 0; pair < 4; ++pair) {
      ivec2 place = start + pair * d;
      vec4 sums[EDGE_VECTORS];
      for (int k = 0; k < EDGE_VECTORS; ++k) sums[k] = pair == 3 ? last_far[k] : far[k];
      {
        ivec2 at = min(place, last), p1 = max(at - d, ivec2(0)) >> 1, q1 = min((at + 2 * d) >> 1, size1 - 1);
        vec4 step = FETCH(level1, p1.y * size1.x + p1.x) - FETCH(level1, q1.y * size1.x + q1.x);
        f[2] = cue(abs(step.x));
        f[3] = cue(length(step.yz));
        f[11] = value_step(step);
        edge_stage1(f, sums);
      }
      vec2 new_weights, new_fluxes;
      [[unroll]] for (int side = 0; side < 2; ++side) {
        ivec2 at = place + side * d.yx;
        vec4 beyond = pixel(at + 2 * d), step = p[side] - q[side], after = q[side] - beyond;
        float after_m = abs(after.x), after_c = length(after.yz);
        f[0] = cue(here_m[side]);
        f[1] = cue(here_c[side]);
        f[8] = clamp((0.5 * (p[side].x + q[side].x) - mean) * (1.0 / 1.5), -2.0, 2.0);
        f[9] = p[side].w + q[side].w - 0.7;
        f[10] = value_step(step);
        f[12] = cue(before_m[side] + after_m);
        f[13] = cue(before_c[side] + after_c);
        f[14] = clamp(0.5 * (min(p[side].x, q[side].x) + 4.0), -1.0, 2.0);
        vec2 result = edge_net(f, sums);
        float on = all(lessThanEqual(at + d, last)) ? 1.0 : 0.0;
        float a = on * push.reflectance_weight * weight(result.x), b = on * push.shading_weight * weight(result.y);
        new_weights[side] = a + b;
        new_fluxes[side] = a * step.x;
        before_m[side] = here_m[side];
        before_c[side] = here_c[side];
        here_m[side] = after_m;
        here_c[side] = after_c;
        p[side] = q[side];
        q[side] = beyond;
      }
      if (kDown) {  // one row gets two more, and then it is the next one's turn
        vec4 row = weights[0], flux_row = fluxes[0];
        [[unroll]] for (int k = 0; k < 3; ++k) {
          weights[k] = weights[k + 1];
          fluxes[k] = fluxes[k + 1];
        }
        weights[3] = vec4(row.zw, new_weights);
        fluxes[3] = vec4(flux_row.zw, new_fluxes);
      } else {  // both rows get one more
        [[unroll]] for (int side = 0; side < 2; ++side) {
          weights[side] = vec4(weights[side].yzw, new_weights[side]);
          fluxes[side] = vec4(fluxes[side].yzw, new_fluxes[side]);
        }
      }
    }
    if (!kDown || run == 1)
      [[unroll]] for (int k = 0; k < (kDown ? 4 : 2); ++k) {
        int y = (kDown ? block.y : start.y) + k;
        uint at = uint(y * packs + block.x / 4);
        if (y <= last.y) {
          STORE(system, SYSTEM_FINE_STRIDE * at + (kDown ? SYSTEM_DOWN : SYSTEM_RIGHT), weights[k]);
          STORE(flux, FLUX_STRIDE * at + (kDown ? FLUX_DOWN : FLUX_RIGHT), fluxes[k]);
        }
      }
  }
}
