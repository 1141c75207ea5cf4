// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "palette.glsl"

// The histogram of a frame: per bin the number of pixels and, in fixed point, the sum of their places in the bin.
PLANE_IN(0, reflectance);
SCALAR_IN(1, scale);
WORD_INOUT(2, counts);

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x) return;
  vec3 r = FETCH(reflectance, int(at.y * push.size.x + at.x)).rgb;
  vec3 color = clamp(exp(r + FETCH1(scale, 0)), 0.0, 1.0) * float(kBins);
  vec3 bin = min(floor(color), float(kBins - 1));
  uvec3 inside = uvec3((color - bin) * push.fraction_scale + 0.5);
  int n = 4 * ((int(bin.r) * kBins + int(bin.g)) * kBins + int(bin.b));
  atomicAdd(counts_data[n], 1u);
  atomicAdd(counts_data[n + 1], inside.r);
  atomicAdd(counts_data[n + 2], inside.g);
  atomicAdd(counts_data[n + 3], inside.b);
}
