// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"

// Input of the network for a pair of gradients (training/olat/README.md): √F, and m = (A - B) / (F + 0.004), F = A + B,
// as six channels of a value (network/value.glsl). Its size is a multiple of the network's total stride; the last row
// and column are repeated beyond the frame.
PLANE_IN(0, a);
PLANE_IN(1, b);
PLANE_OUT(2, image);
PLANE_OUT(3, difference);  // A - B, of the frame
layout(push_constant) uniform Push {
  uvec2 size;    // of the frame
  uvec2 padded;  // of the image
  uint stride, second;  // as lobes.comp
} push;

void main() {
  uvec2 to = gl_GlobalInvocationID.xy, at = min(to, push.size - 1u);
  if (to.x >= push.padded.x) return;
  uint i = to.y * push.padded.x + to.x, pixels = push.padded.x * push.padded.y;
  uint from = at.y * push.stride + at.x;
  vec3 first = finite(FETCH(a, int(from))).rgb, second = finite(FETCH(b, int(from + push.second))).rgb;
  vec3 sum = first + second, root = sqrt(sum), m = (first - second) / (sum + 0.004);
  if (all(lessThan(to, push.size))) STORE(difference, to.y * push.size.x + to.x, vec4(first - second, 0.0));
  STORE(image, 1u + i, vec4(root, m.x));
  STORE(image, 1u + pixels + i, vec4(m.yz, 0.0, 0.0));
}
