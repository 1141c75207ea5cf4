// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "plane.glsl"

// Learns the reflectance of a plane's cells. One that is seen for the first time is learned as it is, with its deviation t for
// s (compare.comp). Later, m and s are means over the frames in which the cell was not hidden, of v and |v − m| / √3, and of
// at most kMemory frames; m of a hidden one moves by kStep a frame, as a running median, so that a change that lasts is
// learned.
PLANE_IN(0, observed);
SCALAR_IN(1, hidden);
PLANE_INOUT(2, learned);
layout(push_constant) uniform Push {
  uvec2 cells;
} push;

const float kMemory = 50.0;  // frames
const float kStep = 0.001;   // ln units a frame

void main() {
  uint n = line_index();
  if (n >= push.cells.x * push.cells.y) return;
  vec4 now = FETCH(observed, int(n));
  if (now.w < 0.0) return;
  vec4 memory = LOAD(learned, 2u * n);
  float spread = LOAD(learned, 2u * n + 1u).x;
  vec3 off = now.rgb - memory.rgb;
  if (memory.w < 1.0) {
    memory = vec4(now.rgb, 1.0);
    spread = now.w;
  } else if (FETCH1(hidden, int(n)) < 0.5) {
    memory.w = min(memory.w + 1.0, kMemory);
    memory.rgb += off / memory.w;
    spread += (sqrt(mean3(off * off)) - spread) / memory.w;
  } else {
    memory.rgb += clamp(off, vec3(-kStep), vec3(kStep));
  }
  STORE(learned, 2u * n, memory);
  STORE(learned, 2u * n + 1u, vec4(spread, 0.0, 0.0, 0.0));
}
