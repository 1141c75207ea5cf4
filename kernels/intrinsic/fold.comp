#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"

// Folds the frame's statistics into the biases of the fitted functions, once a frame. One bias an invocation.
PLANE_IN(0, statistics);
SCALAR_OUT(1, biases);
#define EDGE_NET_TABLES
#include "edge_net.glsl"

const float kBiases[] = FOLD_BIASES;
const vec4 kWeights[] = FOLD_WEIGHTS;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < FOLD_COUNT) STORE(biases, i, kBiases[i] + dot(kWeights[i], FETCH(statistics, 1)));
}
