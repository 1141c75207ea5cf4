// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/guide/guide.glsl"

// Folds the frame's statistics into the biases of the fitted functions, once a frame. One invocation.
PLANE_IN(0, statistics);
PLANE_OUT(1, biases);
#define EDGE_NET_TABLES
#include "edge_net.glsl"

void main() {
  if (gl_GlobalInvocationID.x == 0u) fold_biases(FETCH(statistics, STATISTICS_SIGMAS), FETCH(statistics, STATISTICS_MEAN).y);
}
