#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "guide.glsl"

// EdgePrior, pixels: from local cues of the guide, how much of every step is paint (a) and how much is light (b). One quad
// an invocation; the loops over its pixels and over the two directions are rolled, so that the function is compiled once.
PLANE_IN(0, level0);
PLANE_IN(1, level1);
PLANE_IN(2, cells);
PLANE_IN(3, statistics);
PLANE_IN(4, tuning);
PLANE_OUT(5, system);  // of stride 3
PLANE_OUT(6, flux);
layout(push_constant) uniform Push {
  ivec2 size;
  float reflectance_weight;
  float shading_weight;
} push;
#include "edge_net.glsl"
#include "net.glsl"

// How much more the largest channel steps than the mean does.
float value_step(vec4 step) { return 5.0 * clamp(abs(step.x + step.w) - abs(step.x), -0.4, 0.4); }

void main() {
  int quads = int(QUADS(uint(push.size.x)));
  ivec2 position = ivec2(grid_position(uint(quads)));
  if (position.y >= push.size.y) return;
  ivec2 size1 = (push.size + 1) / 2, size2 = (size1 + 1) / 2;
  float mean = FETCH(statistics, 0).x;
  vec4 right = vec4(0.0), down = vec4(0.0), flux_right = vec4(0.0), flux_down = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    int column = 4 * position.x + k;
    ivec2 at = ivec2(min(column, push.size.x - 1), position.y);
    vec4 p = FETCH(level0, at.y * push.size.x + at.x);
    for (int direction = 0; direction < 2; ++direction) {
      ivec2 d = direction == 0 ? ivec2(1, 0) : ivec2(0, 1);
      ivec2 next = min(at + d, push.size - 1), after = min(at + 2 * d, push.size - 1), before = max(at - d, ivec2(0));
      vec4 q = FETCH(level0, next.y * push.size.x + next.x), step = p - q;
      vec4 step_before = FETCH(level0, before.y * push.size.x + before.x) - p;
      vec4 step_after = q - FETCH(level0, after.y * push.size.x + after.x);
      ivec2 p1 = before >> 1, q1 = min((at + 2 * d) >> 1, size1 - 1);
      vec4 step1 = FETCH(level1, p1.y * size1.x + p1.x) - FETCH(level1, q1.y * size1.x + q1.x);
      ivec2 p2 = max(at - 3 * d, ivec2(0)) >> 2, q2 = min((at + 4 * d) >> 2, size2 - 1);
      int cell_p = CELL_STRIDE * (p2.y * size2.x + p2.x), cell_q = CELL_STRIDE * (q2.y * size2.x + q2.x);
      vec4 step2 = FETCH(cells, cell_p) - FETCH(cells, cell_q);
      vec4 activity = 0.5 * (FETCH(cells, cell_p + 1) + FETCH(cells, cell_q + 1));
      float f[EDGE_CUES];
      f[0] = cue(abs(step.x), 3.0);
      f[1] = cue(length(step.yz), 3.0);
      f[2] = cue(abs(step1.x), 2.5);
      f[3] = cue(length(step1.yz), 2.5);
      f[4] = cue(abs(step2.x), 2.0);
      f[5] = cue(length(step2.yz), 2.0);
      f[6] = cue(activity.x, 2.5);
      f[7] = cue(activity.y, 2.5);
      f[8] = clamp((0.5 * (p.x + q.x) - mean) / 1.5, -2.0, 2.0);
      f[9] = p.w + q.w - 0.7;
      f[10] = value_step(step);
      f[11] = value_step(step1);
      f[12] = cue(abs(step_before.x) + abs(step_after.x), 3.0);
      f[13] = cue(length(step_before.yz) + length(step_after.yz), 3.0);
      f[14] = max(0.5 * (min(p.x, q.x) + 4.0), -1.0);
      vec2 result = edge_net(f);
      float on = column < push.size.x && next != at ? 1.0 : 0.0;
      float a = on * push.reflectance_weight * weight(result.x), b = on * push.shading_weight * weight(result.y);
      bool across = direction == 0;
      right = across ? vec4(right.yzw, a + b) : right;
      flux_right = across ? vec4(flux_right.yzw, a * step.x) : flux_right;
      down = across ? down : vec4(down.yzw, a + b);
      flux_down = across ? flux_down : vec4(flux_down.yzw, a * step.x);
    }
  }
  uint to = uint(position.y * quads + position.x);
  STORE(system, 3u * to + SYSTEM_RIGHT, right);
  STORE(system, 3u * to + SYSTEM_DOWN, down);
  STORE(flux, FLUX_STRIDE * to + FLUX_RIGHT, flux_right);
  STORE(flux, FLUX_STRIDE * to + FLUX_DOWN, flux_down);
}
