#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "quad.glsl"

// Back to the finer level: every pixel gets the correction of its 2 x 2 aggregate. In place, two rows of a quad an
// invocation.
PLANE_IN(0, coarse);
PLANE_IN(1, now);
PLANE_OUT(2, improved);  // the same buffer
layout(push_constant) uniform Push { uvec2 size; } push;  // of the fine level

void main() {
  uint quads = QUADS(push.size.x), half_quads = QUADS((push.size.x + 1u) / 2u);
  uvec2 position = grid_position(quads);
  uint x = position.x, y = position.y;
  if (2u * y >= push.size.y) return;
  vec4 pair = FETCH(coarse, int(y * half_quads + x / 2u));
  vec4 correction = MASKED((x & 1u) == 0u ? pair.xxyy : pair.zzww, INSIDE(x, push.size.x));
  uint at = 2u * y * quads + x;
  STORE(improved, at, FETCH(now, int(at)) + correction);
  if (2u * y + 1u < push.size.y) STORE(improved, at + quads, FETCH(now, int(at + quads)) + correction);
}
