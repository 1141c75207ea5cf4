// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "object.glsl"

// The terms of a cell in the energy of alpha: (weight x probability, weight) of its color and of strokes, and the weights of the edges
// to its left and upper neighbor.
PLANE_IN(0, colors);
SCALAR_IN(1, model);
PLANE_IN(2, totals);
PLANE_IN(3, memory);
WORD_IN(4, region);
PLANE_OUT(5, terms);
layout(push_constant) uniform Push { uvec2 cells; } push;

float edge(vec3 a, vec3 b) {
  vec3 d = a - b;
  return kEdgeWeight * exp(-dot(d, d) / (2.0 * kEdgeScale * kEdgeScale));
}

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  int n = int(cell.y * push.cells.x + cell.x);
  vec3 color = FETCH(colors, n).rgb;
  int bin = bin_of(color);
  float min_density = kDensityFloor * FETCH(totals, 0).y + 1e-30;
  // A color under both kinds of strokes is not evidence: edges decide.
  float own = max(FETCH1(model, bin), FETCH1(model, kAddedDensity * kBinCount + bin)) + min_density;
  float other = max(FETCH1(model, kBackgroundDensity * kBinCount + bin), FETCH1(model, kSubtractedDensity * kBinCount + bin)) + min_density;
  float certain = min(abs(log(own / other)) / 3.0, 1.0);
  // Where colors tell nothing, a cell stays what it was unless its neighbors change.
  float p = mix(float(FETCH1(region, n)), own / (own + other), certain), weight = kPriorWeight * certain * certain + kPriorFloor;
  float strokes = FETCH(memory, n).w;
  float decided = abs(strokes) > 1.0 ? kSeedWeight : kPathWeight * abs(strokes) * (1.0 - certain) * (1.0 - certain);
  STORE(terms, uint(n),
        vec4(weight * p + (strokes > 0.0 ? decided : 0.0), weight + decided, cell.x > 0u ? edge(color, FETCH(colors, n - 1).rgb) : 0.0,
             cell.y > 0u ? edge(color, FETCH(colors, n - int(push.cells.x)).rgb) : 0.0));
}
