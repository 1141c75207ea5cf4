#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "quad.glsl"

// The pixels' own terms of energy.glsl: gauge prior and temporal anchor, as mass and right-hand side; and where the
// solve starts: at what the previous frame says where it may be believed, at the gauge prior's target elsewhere. One
// quad an invocation. `trust` is 0 without a previous frame; `control[0].x` is 0 at a scene cut.
PLANE_IN(0, mean);
PLANE_IN(1, excess);
PLANE_IN(2, chroma0);
PLANE_IN(3, chroma1);
PLANE_IN(4, before);  // of the previous frame, three vec4 a quad: r = m - s, c0, c1
PLANE_IN(5, control);
PLANE_OUT(6, system);
PLANE_OUT(7, anchored);
PLANE_OUT(8, shading);
layout(push_constant) uniform Push {
  uvec2 size;
  float gauge;     // v
  float temporal;  // w_t
  float spread2;   // k^2
  float trust;
} push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  uint x = position.x, y = position.y;
  if (y >= push.size.y) return;
  bvec4 inside = INSIDE(x, push.size.x);
  uint at = y * quads + x;
  vec4 m = FETCH(mean, int(at)), target = m + FETCH(excess, int(at));
  vec4 mass = vec4(push.gauge), rhs = push.gauge * target, start = target;
  if (push.trust > 0.0) {
    vec4 d0 = FETCH(chroma0, int(at)) - FETCH(before, int(3u * at + 1u));
    vec4 d1 = FETCH(chroma1, int(at)) - FETCH(before, int(3u * at + 2u));
    vec4 same = push.trust * FETCH(control, 0).x * exp(-push.spread2 * (0.5 * d0 * d0 + (2.0 / 3.0) * d1 * d1));
    vec4 kept = m - FETCH(before, int(3u * at));
    mass += push.temporal * same;
    rhs += push.temporal * same * kept;
    start = mix(target, kept, same);
  }
  STORE(system, SYSTEM_STRIDE * at + SYSTEM_MASS, MASKED(mass, inside));
  STORE(anchored, at, MASKED(rhs, inside));
  STORE(shading, at, MASKED(start, inside));
}
