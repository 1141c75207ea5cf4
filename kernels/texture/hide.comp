// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "plane.glsl"

// What stands before the plane: cells whose excess e (compare.comp) is above a tolerance,
//
//   hidden = 1 − falling((e − τ) / softness)
//
// τ is the tolerance, and kNear of it within a neighborhood that is hidden: a thing covers spots that happen to look like
// it, too.
SCALAR_IN(0, excess);
SCALAR_OUT(1, hidden);  // a cell: 0…1
layout(push_constant) uniform Push {
  uvec2 cells;
  float tolerance;
  float fall_off;  // 1 / softness
} push;

const float kNear = 0.3;
const float kHiddenMin = 0.2, kHiddenMax = 0.5;  // shares of the neighborhood that is hidden
const int kReach = 4;                 // of the neighborhood, cells

float over(float e, float tolerance) { return 1.0 - falling((e - tolerance) * push.fall_off); }

void main() {
  uint n = line_index();
  if (n >= push.cells.x * push.cells.y) return;
  ivec2 cell = ivec2(n % push.cells.x, n / push.cells.x), last = ivec2(push.cells) - 1;
  float sum = 0.0, count = 0.0;
  for (int y = -kReach; y <= kReach; y += 2)
    for (int x = -kReach; x <= kReach; x += 2, ++count) {
      ivec2 at = clamp(cell + ivec2(x, y), ivec2(0), last);
      sum += over(FETCH1(excess, at.y * int(push.cells.x) + at.x), push.tolerance);
    }
  float near = 1.0 - falling((sum / count - kHiddenMin) / (kHiddenMax - kHiddenMin));
  STORE(hidden, n, over(FETCH1(excess, int(n)), push.tolerance * (1.0 - (1.0 - kNear) * near)));
}
