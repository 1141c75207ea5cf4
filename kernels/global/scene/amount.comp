// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"
#include "global/model/counts.glsl"

// For every candidate amount of indirect light: the histogram of the chroma that is left at the points of the grid, and
// how neutral it is. One point an invocation.
PLANE_IN(0, colors);
PLANE_IN(1, points);
WORD_IN(2, labels);
PLANE_IN(3, received);
WORD_INOUT(4, counts);  // kCandidates histograms, then for each two sums: weight that is neutral, all weight
layout(push_constant) uniform Push {
  SIZES
  float min_amount, ratio;  // the first candidate, and each to the one before
  float neutral;       // 1 / (2 width²), width the range of chroma that counts as neutral
} push;

const float kMinShading = 1e-4;
const int kAround = 1;  // points

void main() {
  int i = int(line_index());
  if (i >= push.grid.x * push.grid.y) return;
  vec4 point = FETCH(points, i);
  float weight = FETCH(colors, i).w;
  if (weight <= 0.0) return;
  // Errors of shading that average out around a point do not count.
  ivec2 at = ivec2(i % push.grid.x, i / push.grid.x);
  float sum = 0.0, all = 0.0;
  for (int y = max(at.y - kAround, 0); y <= min(at.y + kAround, push.grid.y - 1); ++y)
    for (int x = max(at.x - kAround, 0); x <= min(at.x + kAround, push.grid.x - 1); ++x) {
      ivec2 off = ivec2(x, y) - at;
      float share = exp(-float(off.x * off.x + off.y * off.y));
      sum += share * log(FETCH(points, y * push.grid.x + x).z + kMinShading);
      all += share;
    }
  float shading = exp(sum / all);
  vec3 light;
  RECEIVED(light, int(FETCH1(labels, i)), i % push.grid.x, i / push.grid.x, 2.0)
  light *= push.min_amount;
  for (int k = 0; k < kCandidates; ++k) {
    vec2 left = point.xy - chroma_of(light_of(shading, light));
    COUNT(counts, k * kBinCount, left, weight)
    int sums = kCandidates * kBinCount + 2 * k;
    atomicAdd(LOAD(counts, sums), counted(weight * exp(-push.neutral * dot(left, left))));
    atomicAdd(LOAD(counts, sums + 1), counted(weight));
    light *= push.ratio;
  }
}
