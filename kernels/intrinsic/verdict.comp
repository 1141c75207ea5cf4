#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"

// Whether a frame continues the one before. One workgroup of 64.
//   verdict[0] = mean mismatch of the frame, 1 where it is anchored or 0 at a cut, -, -
PLANE_IN(0, sums);
PLANE_OUT(1, verdict);
layout(push_constant) uniform Push {
  uint count;
  float cells;
  float cut_fraction;
} push;

shared vec4 totals[64];

void main() {
  uint lane = gl_LocalInvocationID.x;
  vec4 sum = vec4(0.0);
  for (uint i = lane; i < push.count; i += 64u) sum += FETCH(sums, int(i));
  totals[lane] = sum;
  barrier();
  if (lane > 0u) return;
  for (uint i = 1u; i < 64u; ++i) sum += totals[i];
  float mean = sum.x / push.cells;
  STORE(verdict, 0, vec4(mean, mean < push.cut_fraction ? 1.0 : 0.0, sum.y / max(sum.z, 1e-20), sum.z / push.cells));
}
