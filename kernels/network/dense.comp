#version 450
#extension GL_GOOGLE_include_directive : require
#include "value.glsl"

// Four numbers of a dense node: of everything in the image, with bias and activation. The elements of a value are read in the
// order in which they lie, and the weights were laid out for that: [block] of bias, then [element][channel][block].
PLANE_IN(0, image);
PLANE_IN(1, weights);
PLANE_OUT(2, result);
layout(push_constant) uniform Push {
  int elements, blocks;
  float slope;
} push;

void main() {
  int block = int(gl_GlobalInvocationID.x);
  if (block >= push.blocks) return;
  vec4 sum = FETCH(weights, block);
  int weight = push.blocks + block;
  for (int i = 1; i <= push.elements; ++i) {
    vec4 v = FETCH(image, i);
    sum += v.r * FETCH(weights, weight) + v.g * FETCH(weights, weight + push.blocks) +
           v.b * FETCH(weights, weight + 2 * push.blocks) + v.a * FETCH(weights, weight + 3 * push.blocks);
    weight += 4 * push.blocks;
  }
  STORE(result, 1 + block, activated(sum, push.slope));
}
