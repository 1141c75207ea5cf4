#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "quad.glsl"

// The solution as layers: S = e^s, R = I / S (so that R S = I exactly), and what the next frame wants to know of this
// one: r = m - s, c0, c1. One quad an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, shading);
PLANE_IN(2, mean);
PLANE_IN(3, chroma0);
PLANE_IN(4, chroma1);
PLANE_OUT(5, intrinsic);
PLANE_OUT(6, kept);
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint quads = QUADS(push.size.x);
  uvec2 position = grid_position(quads);
  uint x = position.x, y = position.y;
  if (y >= push.size.y) return;
  uint at = y * quads + x;
  vec4 s = FETCH(shading, int(at));
  STORE(kept, 3u * at, FETCH(mean, int(at)) - s);
  STORE(kept, 3u * at + 1u, FETCH(chroma0, int(at)));
  STORE(kept, 3u * at + 2u, FETCH(chroma1, int(at)));
  s = clamp(s, -20.0, 20.0);
  vec4 light = exp(s), dark = exp(-s);
  for (uint k = 0u; k < 4u; ++k) {
    uint px = 4u * x + k;
    if (px < push.size.x) {
      uint pixel = y * push.size.x + px;
      vec3 rgb = FETCH(frame, int(pixel)).rgb;
      rgb = mix(vec3(0.0), mix(min(rgb, 1e4), vec3(1.0), isinf(rgb)), greaterThan(rgb, vec3(0.0)));
      STORE(intrinsic, pixel, vec4(rgb * dark[k], light[k]));
    }
  }
}
