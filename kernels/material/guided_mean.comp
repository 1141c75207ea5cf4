#version 450
#extension GL_GOOGLE_include_directive : require
#include "guided.glsl"

// Each point is on the lines of all around it that count: their mean.
layout(constant_id = 1) const bool kBeyond = true;  // whether points that do not count have one, too
PLANE_IN(0, points);   // w: whether it counts
PLANE_IN(1, lines);    // slopes and offset, whatever they are of
PLANE_OUT(2, result);
layout(push_constant) uniform Push { int side; } push;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= push.side * push.side) return;
  vec4 sum = vec4(0.0);
  float count = 0.0;
  ivec4 window = around(i, push.side);
  for (int y = window.y; y <= window.w; ++y)
    for (int x = window.x; x <= window.z; ++x) {
      int j = y * push.side + x;
      if (FETCH(points, j).w == 0.0) continue;
      sum += FETCH(lines, j);
      count += 1.0;
    }
  bool told = count > 0.0 && (kBeyond || FETCH(points, i).w != 0.0);
  STORE(result, i, told ? sum / count : vec4(0.0));
}
