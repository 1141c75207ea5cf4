// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "guided.glsl"

// Mean of the regressions of all valid points around each point, which smooths network outputs. Invalid points get a
// line for the specular layer, for pixels between points; for the mask they get none.
layout(constant_id = 1) const bool kBeyond = true;
PLANE_IN(0, lines);    // slopes and offset, of either
PLANE_OUT(1, result);
layout(push_constant) uniform Push { int side; } push;

void main() {
  int i = int(line_index());
  if (i >= push.side * push.side) return;
  vec4 sum = vec4(0.0);
  float count = 0.0;
  ivec4 window = around(i, push.side);
  for (int y = window.y; y <= window.w; ++y)
    for (int x = window.x; x <= window.z; ++x) {
      vec4 line = FETCH(lines, y * push.side + x);
      bool counts = line.w != kNone;
      sum += counts ? line : vec4(0.0);
      count += float(counts);
    }
  bool known = kBeyond || FETCH(lines, i).w != kNone;
  STORE(result, i, known ? sum / max(count, 1.0) : vec4(0.0));
}
