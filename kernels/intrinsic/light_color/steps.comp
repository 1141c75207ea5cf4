// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "light.glsl"

// Counts the steps from every point to the one at its right and below, from the brighter to the darker (light.glsl). Steps of light
// have the slope k, at all sizes, and no dg. One point of all levels an invocation.
PLANE_IN(0, fine);
PLANE_IN(1, coarse);
WORD_INOUT(2, counts);
layout(push_constant) uniform Push { uvec2 cells; } push;

void count(uint level, vec4 one, vec4 other) {
  if (one.x < other.x) {
    vec4 kept = one;
    one = other;
    other = kept;
  }
  vec3 step = one.xyz - other.xyz;
  float tint = abs(step.z), dark = 1.0 / (1.0 + exp(-3.0 * (other.x + 4.0)));
  int size = int(clamp(floor(1.6 * log2(max(step.x, 1e-3) / 0.03)), -1.0, float(STEP_SIZES - 2))) + 1;
  int tinted = (tint > 0.02 + 0.08 * step.x ? 1 : 0) + (tint > 0.06 + 0.3 * step.x ? 1 : 0);
  float place = clamp(step.y / max(step.x, 0.01) / kSlopeWidth + float(STEP_SLOPES / 2), 0.0, float(STEP_SLOPES - 1) - 0.001);
  uint at = uint(((int(level) * STEP_TINTS + tinted) * STEP_SIZES + size) * STEP_SLOPES) + uint(place);
  float weight = dark / kStepUnit, share = fract(place);
  atomicAdd(counts_data[at], uint(weight * (1.0 - share) + 0.5));
  atomicAdd(counts_data[at + 1u], uint(weight * share + 0.5));
}

vec4 point(uint level, uint i) {
  uint first = push.cells.x * push.cells.y;
  return level == 0u ? FETCH(fine, int(i)) : FETCH(coarse, int(i - first));
}

void main() {
  uint i = line_index();
  if (i >= level_start(push.cells, uint(LIGHT_LEVELS))) return;
  uint level = 0u;
  while (level + 1u < uint(LIGHT_LEVELS) && i >= level_start(push.cells, level + 1u)) ++level;
  uint within = i - level_start(push.cells, level);
  uvec2 size = level_size(push.cells, level);
  vec4 here = point(level, i);
  if (within % size.x + 1u < size.x) count(level, here, point(level, i + 1u));
  if (within / size.x + 1u < size.y) count(level, here, point(level, i + size.x));
}
