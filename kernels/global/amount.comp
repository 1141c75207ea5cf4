#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "model.glsl"
#include "counts.glsl"

// For every candidate amount of indirect light: the histogram of the chroma that is left at the points of the grid, and
// how neutral it is. One point an invocation.
PLANE_IN(0, colors);
PLANE_IN(1, points);
WORD_IN(2, labels);
PLANE_IN(3, received);
WORD_INOUT(4, counts);  // kCandidates histograms, then for each two sums: weight that is neutral, all weight
layout(push_constant) uniform Push {
  SIZES
  float least, ratio;  // the first candidate, and each to the one before
  float neutral;       // 1 / (2 width²) of what counts as neutral
} push;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= push.grid.x * push.grid.y) return;
  vec4 point = FETCH(points, i);
  float weight = FETCH(colors, i).w;
  if (weight <= 0.0) return;
  vec3 light;
  RECEIVED(light, int(FETCH1(labels, i)), i % push.grid.x, i / push.grid.x, 2.0)
  light *= push.least;
  for (int k = 0; k < kCandidates; ++k) {
    vec2 left = point.xy - chroma_of(light_of(point.z, light));
    COUNT(counts, k * kBinCount, left, weight)
    int sums = kCandidates * kBinCount + 2 * k;
    atomicAdd(LOAD(counts, sums), counted(weight * exp(-push.neutral * dot(left, left))));
    atomicAdd(LOAD(counts, sums + 1), counted(weight));
    light *= push.ratio;
  }
}
