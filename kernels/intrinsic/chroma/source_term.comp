// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"

// The source term of the cells at s' after a correction: target - screening (s' + correction). The finer levels relax against it.
// With kMeasure also sums the squared source term of the chroma bins, F = g (m' - r_bin - s'): without bins s' would change by less
// than F / v, in the mean over cells weighted by v. One pack of cells an invocation.
layout(constant_id = 1) const bool kMeasure = false;
PLANE_IN(0, terms);
PLANE_IN(1, target);
PLANE_IN(2, mean);
PLANE_IN(3, correction);
PLANE_OUT(4, source_term);
PLANE_OUT(5, sums);
#define BINDING_EFFECT 0  // sum of v (F / v)^2
#define BINDING_WEIGHT 1  // sum of v
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 2

void main() {
  uvec2 position = grid_position(PACK4(push.size.x));
  vec4 binding = vec4(0.0);
  if (position.y < push.size.y) {
    int at = int(position.y * PACK4(push.size.x) + position.x);
    bvec4 inside = INSIDE(position.x, push.size.x);
    vec4 s = FETCH(mean, at) + FETCH(correction, at), rhs = FETCH(target, at), screening = FETCH(terms, TERMS_STRIDE * at + TERMS_SCREENING);
    STORE(source_term, SOURCE_STRIDE * uint(at) + SOURCE_VALUE, MASKED(rhs - screening * s, inside));
    if (kMeasure) {
      vec4 g = FETCH(terms, TERMS_STRIDE * at + TERMS_CHROMA), v = MASKED(max(screening - g, 1e-6 * screening), inside);
      vec4 data = MASKED(rhs - FETCH(terms, TERMS_STRIDE * at + TERMS_DATA) - g * s, inside);
      binding[BINDING_EFFECT] = dot(data, data / max(v, 1e-20));
      binding[BINDING_WEIGHT] = dot(v, vec4(1.0));
    }
  }
  if (kMeasure) SUM_PARTIALS(sums, binding);
}
