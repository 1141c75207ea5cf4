#version 450
#extension GL_GOOGLE_include_directive : require
#include "guided.glsl"

// Each point is on the lines of all around it: their mean.
PLANE_IN(0, lines);    // slope, offset, 0, mask
PLANE_OUT(1, result);  // slope, offset
layout(push_constant) uniform Push { int side; } push;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= push.side * push.side) return;
  vec4 sum = vec4(0.0);
  ivec4 window = around(i, push.side);
  for (int y = window.y; y <= window.w; ++y)
    for (int x = window.x; x <= window.z; ++x) sum += FETCH(lines, y * push.side + x);
  STORE(result, i, vec4(sum.xy / max(sum.w, 1.0), 0.0, 0.0));
}
