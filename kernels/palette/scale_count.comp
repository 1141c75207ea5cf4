// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "palette.glsl"

// Counts the values of ln R over all channels.
PLANE_IN(0, reflectance);
WORD_INOUT(1, counts);

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x) return;
  vec3 r = FETCH(reflectance, int(at.y * push.size.x + at.x)).rgb;
  uvec3 bin = uvec3(clamp((r + 16.0) * (float(kScaleBins) / 32.0), 0.0, float(kScaleBins - 1)));
  atomicAdd(counts_data[bin.r], 1u);
  atomicAdd(counts_data[bin.g], 1u);
  atomicAdd(counts_data[bin.b], 1u);
}
