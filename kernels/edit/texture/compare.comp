// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "plane.glsl"

// What stands before the plane: cells of the plane whose reflectance differs from the one learned for them. With v the mean
// of ln (R + ε) over a cell now, t the spread of that between its five samples, and m, s what is learned of both,
//
//   d = |v − m| / √3        hidden = 1 − falling((d − tolerance − 2 s) / softness)
//
// A cell that is seen for the first time is learned as it is. Later, m and s are means over the frames in which the cell was
// not hidden, of at most kMemory frames; m of a hidden one moves by kStep a frame, as a running median, so that a change
// that lasts is learned.
PLANE_IN(0, model);       // R.rgb, S of the decomposer
PLANE_INOUT(1, learned);  // a cell: (m, frames), (s, 0, 0, 0)
SCALAR_OUT(2, hidden);    // a cell: 0…1
layout(push_constant) uniform Push {
  vec4 to_frame[3];  // rows of the homography from the unit square to pixels
  uvec2 size;        // of the frame
  uvec2 cells;
  float tolerance;
  float fall_off;  // 1 / softness
  uint afresh;     // 1: nothing is learned yet
} push;

const float kMemory = 50.0;  // frames
const float kStep = 0.001;   // ln units a frame
const float kCompareFloor = 0.02;

vec3 read_model(int n) { return log(finite(FETCH(model, n)).rgb + kCompareFloor); }

void main() {
  uint n = line_index();
  if (n >= push.cells.x * push.cells.y) return;
  vec2 cell = vec2(n % push.cells.x, n / push.cells.x) + 0.5;
  vec4 memory = push.afresh != 0u ? vec4(0.0) : LOAD(learned, 2u * n);
  float spread = push.afresh != 0u ? 0.0 : LOAD(learned, 2u * n + 1u).x;
  vec3 sum = vec3(0.0), squares = vec3(0.0);
  bool seen = true;
  for (int k = 0; k < 5; ++k) {
    vec2 offset = k == 4 ? vec2(0.0) : vec2(k & 1, k >> 1) - 0.5;
    float depth;
    vec2 at = mapped(push.to_frame, (cell + offset) / vec2(push.cells), depth);
    seen = seen && depth > 0.0 && all(greaterThanEqual(at, vec2(0.0))) && all(lessThanEqual(at, vec2(push.size)));
    if (!seen) break;
    Between b = between(at, push.size);
    int width = int(push.size.x);
    vec3 value = BILINEAR(read_model, b, width);
    sum += value;
    squares += value * value;
  }
  float covered = 0.0;
  if (seen) {
    vec3 value = sum / 5.0;
    float now = sqrt(max(mean3(squares / 5.0 - value * value), 0.0));
    if (memory.w < 1.0) {
      memory = vec4(value, 1.0);
      spread = now;
    } else {
      vec3 off = value - memory.rgb;
      float difference = sqrt(mean3(off * off));
      covered = 1.0 - falling((difference - push.tolerance - 2.0 * spread) * push.fall_off);
      if (covered < 0.5) {
        memory.w = min(memory.w + 1.0, kMemory);
        memory.rgb += off / memory.w;
        spread += (max(now, difference) - spread) / memory.w;
      } else {
        memory.rgb += clamp(off, vec3(-kStep), vec3(kStep));
      }
    }
  }
  STORE(learned, 2u * n, memory);
  STORE(learned, 2u * n + 1u, vec4(spread, 0.0, 0.0, 0.0));
  STORE(hidden, n, covered);
}
