#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../intrinsic/quad.glsl"
#include "../intrinsic/temporal.glsl"
#include "global.glsl"

// Box means of the frame and of its shading, as far as that is known: at the reflectance of the frame before, and, for first
// frames and cuts, as if the largest channel of every albedo were the same. One point of the grid an invocation.
PLANE_IN(0, frame);
PLANE_IN(1, memory);   // m of the frame before
PLANE_IN(2, shading);  // and its s
PLANE_IN(3, gauge);
PLANE_OUT(4, points);  // mean I, mean shading
PLANE_OUT(5, cues);    // z, weight, mean shading of a first frame
layout(push_constant) uniform Push {
  uvec2 size;
  uint factor;
  uint first;
} push;

void main() {
  uvec2 grid = (push.size + push.factor - 1u) / push.factor, point = grid_position(grid.x);
  if (point.y >= grid.y) return;
  uvec2 from = push.factor * point, to = min(from + push.factor, push.size);
  uint quads = QUADS(push.size.x);
  float scale = FETCH(gauge, 0).x;
  vec4 sum = vec4(0.0);
  float bright = 0.0;
  for (uint y = from.y; y < to.y; ++y)
    for (uint x = from.x; x < to.x; ++x) {
      vec3 rgb = sanitize(FETCH(frame, int(y * push.size.x + x)).rgb), light = rgb + kFloor;
      int quad = int(y * quads + x / 4u);
      float m = log(light.r * light.g * light.b) / 3.0;
      float before = FETCH(shading, quad)[x & 3u] - FETCH(memory, MEMORY_STRIDE * quad + MEMORY_MEAN)[x & 3u];
      sum += vec4(rgb, exp(m + before - scale));
      bright += brightest_of(rgb) / kBrightest;
    }
  float share = 1.0 / float((to.x - from.x) * (to.y - from.y));
  sum *= share;
  float light = mean_of(sum.rgb);
  bool fair = light > 0.01 && brightest_of(sum.rgb) < 0.98;
  uint at = point.y * grid.x + point.x;
  STORE(points, at, push.first != 0u ? vec4(sum.rgb, share * bright) : sum);
  STORE(cues, at, vec4(chroma_of(sum.rgb), fair ? light : 0.0, share * bright));
}
