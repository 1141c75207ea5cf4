#version 450
#extension GL_GOOGLE_include_directive : require
#include "guided.glsl"

// Each point is on the lines of all around it that count: their mean. Lines of the specular layer have the mean of slopes and go
// through their point, so that nothing of what SpecularNet says there is lost; those of the mask smooth what SegmentationNet
// says. Points that do not count have a line of the specular layer, for pixels between, and none of the mask.
layout(constant_id = 1) const bool kSpecular = true;
PLANE_IN(0, points);   // guide, layer, 0, whether it counts; or color, probability
PLANE_IN(1, lines);    // slope, offset, 0, 0; or slopes, offset
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
  vec4 line = sum / max(count, 1.0), here = FETCH(points, i);
  if (here.w != 0.0 && kSpecular) line.y = here.y - line.x * here.x;
  if (here.w == 0.0 && !kSpecular) line = vec4(0.0);
  STORE(result, i, line);
}
