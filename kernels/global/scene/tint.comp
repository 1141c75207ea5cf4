// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"
#include "global/model/counts.glsl"

// The tint of light at the points of the grid, its indirect share, the weight of a point for its base color (more in direct light),
// and sums for the scene. And the histogram of chroma without the tint.
PLANE_IN(0, colors);
PLANE_IN(1, points);
WORD_IN(2, labels);
PLANE_IN(3, received);
PLANE_IN(4, scene);
WORD_INOUT(5, counts);
PLANE_OUT(6, tints);  // tint, fraction, weight
PLANE_OUT(7, sums);   // |t|², f², w |t|², w
layout(push_constant) uniform Push { SIZES } push;

void main() {
  int i = int(line_index());
  vec4 sum = vec4(0.0);
  if (i < push.grid.x * push.grid.y) {
    vec4 point = FETCH(points, i), known = FETCH(scene, SCENE_AMOUNT);
    vec3 light;
    RECEIVED(light, int(FETCH1(labels, i)), i % push.grid.x, i / push.grid.x, 2.0)
    light = known[AMOUNT_KAPPA] * colored_by(FETCH(scene, SCENE_WHITE).z, light);
    vec2 tint = chroma_of(light_of(point.z, light));
    float f = fraction_of(point.z, light);
    float weight = (0.5 + 0.5 * FETCH(colors, i).w / known[AMOUNT_WEIGHT]) / (1.0 + 9.0 * f * f);
    STORE(tints, i, vec4(tint, f, weight));
    COUNT(counts, 0, point.xy - tint, weight)
    float size2 = dot(tint, tint);
    sum = vec4(size2, f * f, weight * size2, weight);
  }
  SUM_PARTIALS(sums, sum);
}
