// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "plane.glsl"

// Cells of a plane beside what is learned of them. With v the mean of ln (R + ε) over a cell now, t the deviation of that
// between its five samples, and m, s what is learned of both, the excess is
//
//   e = |v − m| / √3 − 2 s
//
// and 0 where nothing is learned yet, or where the cell is not in the frame.
PLANE_IN(0, model);     // R.rgb, S of the decomposer
PLANE_IN(1, learned);   // a cell: (m, frames), (s, 0, 0, 0)
PLANE_OUT(2, observed);  // a cell: (v, t); t < 0: it is not in the frame
SCALAR_OUT(3, excess);
layout(push_constant) uniform Push {
  vec4 to_frame[3];  // rows of the homography from the unit square to pixels
  uvec2 size;        // of the frame
  uvec2 cells;
} push;

const float kCompareFloor = 0.02;

vec3 read_model(int n) { return log(finite(FETCH(model, n)).rgb + kCompareFloor); }

void main() {
  uint n = line_index();
  if (n >= push.cells.x * push.cells.y) return;
  vec2 cell = vec2(n % push.cells.x, n / push.cells.x) + 0.5;
  vec3 sum = vec3(0.0), squares = vec3(0.0);
  for (int k = 0; k < 5; ++k) {
    vec2 offset = k == 4 ? vec2(0.0) : vec2(k & 1, k >> 1) - 0.5;
    float depth;
    vec2 at = mapped(push.to_frame, (cell + offset) / vec2(push.cells), depth);
    if (!(depth > 0.0 && all(greaterThanEqual(at, vec2(0.0))) && all(lessThanEqual(at, vec2(push.size))))) {
      STORE(observed, n, vec4(0.0, 0.0, 0.0, -1.0));
      STORE(excess, n, 0.0);
      return;
    }
    Between b = between(at, push.size);
    int width = int(push.size.x);
    vec3 value = BILINEAR(read_model, b, width);
    sum += value;
    squares += value * value;
  }
  vec3 value = sum / 5.0;
  vec4 memory = FETCH(learned, int(2u * n));
  vec3 off = value - memory.rgb;
  STORE(observed, n, vec4(value, sqrt(max(mean3(squares / 5.0 - value * value), 0.0))));
  STORE(excess, n, memory.w < 1.0 ? 0.0 : sqrt(mean3(off * off)) - 2.0 * FETCH(learned, int(2u * n + 1u)).x);
}
