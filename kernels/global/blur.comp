#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// A zero-padded Gaussian along rows or columns of every base color's plane. One point of one plane an invocation.
layout(constant_id = 1) const bool kColumns = false;
PLANE_IN(0, sharp);
PLANE_OUT(1, blurred);
layout(push_constant) uniform Push {
  uvec2 size;   // of a plane
  float sigma;  // points
  float norm;   // 1 / sum of the taps
  int reach;
} push;

void main() {
  uint count = push.size.x * push.size.y, i = gl_GlobalInvocationID.x;
  if (i >= kSlots * count) return;
  uvec2 place = place_of(i % count, push.size.x);
  int along = int(kColumns ? place.y : place.x), length = int(kColumns ? push.size.y : push.size.x);
  int step = kColumns ? int(push.size.x) : 1, start = int(i) - along * step;
  float sharpness = -0.5 / (push.sigma * push.sigma);
  vec4 sum = vec4(0.0);
  for (int u = max(0, along - push.reach); u <= min(length - 1, along + push.reach); ++u) {
    float d = float(u - along);
    sum += exp(sharpness * d * d) * FETCH(sharp, start + u * step);
  }
  STORE(blurred, i, push.norm * sum);
}
