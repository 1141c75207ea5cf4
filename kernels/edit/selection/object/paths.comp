// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// A pass of shortest paths from strokes that add (x) and that subtract (y), along each row or column, there and back.
layout(constant_id = 1) const bool ROWS = true;
layout(constant_id = 2) const bool FIRST = false;  // starts from the strokes
PLANE_IN(0, colors);
WORD_IN(1, seeds);
PLANE_INOUT(2, paths);
layout(push_constant) uniform Push { uvec2 cells; } push;

vec2 length_at(int n) {
  if (!FIRST) return LOAD(paths, n).xy;
  uint seed = FETCH1(seeds, n);
  return vec2(seed == kSeedAdd ? 0.0 : kNoPath, seed == kSeedSubtract ? 0.0 : kNoPath);
}

void main() {
  int line = int(line_index()), width = int(push.cells.x);
  if (line >= (ROWS ? int(push.cells.y) : width)) return;
  int count = ROWS ? width : int(push.cells.y), stride = ROWS ? 1 : width, n = ROWS ? line * width : line;
  vec3 before = FETCH(colors, n).rgb;
  vec2 path = length_at(n);
  STORE(paths, n, vec4(path, 0.0, 0.0));
  for (int i = 1; i < count; ++i) {
    n += stride;
    vec3 color = FETCH(colors, n).rgb;
    path = min(length_at(n), path + kStep + distance(color, before) / kEdgeScale);
    STORE(paths, n, vec4(path, 0.0, 0.0));
    before = color;
  }
  for (int i = 1; i < count; ++i) {
    n -= stride;
    vec3 color = FETCH(colors, n).rgb;
    path = min(LOAD(paths, n).xy, path + kStep + distance(color, before) / kEdgeScale);
    STORE(paths, n, vec4(path, 0.0, 0.0));
    before = color;
  }
}
