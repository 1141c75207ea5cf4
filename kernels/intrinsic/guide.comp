#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "quad.glsl"

// Frame to guide: linear RGB pixels to quads of m, u, c0, c1 (energy.glsl). One quad an invocation.
// NaN and negative light count as 0, +Inf and anything above kMost as kMost.
PLANE_IN(0, frame);
PLANE_OUT(1, mean);
PLANE_OUT(2, excess);
PLANE_OUT(3, chroma0);
PLANE_OUT(4, chroma1);
layout(push_constant) uniform Push {
  uvec2 size;
  float intensity_floor;
  float chroma_floor;
} push;

const float kMost = 1e4;

vec3 light(uint x, uint y) {
  vec3 rgb = FETCH(frame, int(y * push.size.x + min(x, push.size.x - 1u))).rgb;
  // NaN fails every comparison; infinity is a full-scale pixel (a broken sample, not a light).
  return mix(vec3(0.0), mix(min(rgb, kMost), vec3(1.0), isinf(rgb)), greaterThan(rgb, vec3(0.0)));
}

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  uint x = position.x, y = position.y;
  if (y >= push.size.y) return;
  vec3 p0 = light(4u * x, y), p1 = light(4u * x + 1u, y), p2 = light(4u * x + 2u, y), p3 = light(4u * x + 3u, y);
  vec4 r = vec4(p0.r, p1.r, p2.r, p3.r), g = vec4(p0.g, p1.g, p2.g, p3.g), b = vec4(p0.b, p1.b, p2.b, p3.b);
  bvec4 inside = INSIDE(x, push.size.x);
  vec4 m = log((r + push.intensity_floor) * (g + push.intensity_floor) * (b + push.intensity_floor)) / 3.0;
  vec4 u = log(max(max(r, g), b) + push.intensity_floor) - m;
  vec4 lr = log(r + push.chroma_floor), lg = log(g + push.chroma_floor), lb = log(b + push.chroma_floor);
  uint at = y * quads + x;
  STORE(mean, at, MASKED(m, inside));
  STORE(excess, at, MASKED(u, inside));
  STORE(chroma0, at, MASKED(lr - lg, inside));
  STORE(chroma1, at, MASKED(0.5 * (lr + lg) - lb, inside));
}
