// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "light.glsl"

// The network's input from the counts of steps, which are cleared: ln(1 + 2 c), c the steps of a thousand pairs of neighbors of a
// level. One count an invocation.
WORD_INOUT(0, counts);
SCALAR_OUT(1, features);
layout(push_constant) uniform Push { uvec2 cells; } push;

void main() {
  uint i = line_index();
  if (i >= uint(STEP_COUNT)) return;
  uvec2 size = level_size(push.cells, i / uint(STEP_COUNT / LIGHT_LEVELS));
  STORE(features, i, log(1.0 + 2.0 * 1000.0 * kStepUnit * float(LOAD(counts, i)) / float(2u * size.x * size.y)));
  STORE(counts, i, 0u);
}
