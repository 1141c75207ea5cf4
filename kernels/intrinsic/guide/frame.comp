// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "guide.glsl"
#include "intrinsic/light_color/light.glsl"

// Reduces the partial sums to the statistics of the frame. One workgroup.
layout(constant_id = 1) const bool kColored = false;
PLANE_IN(0, intensity_sums);
PLANE_IN(1, chromatic_sums);
PLANE_IN(2, plain_sums);
PLANE_IN(3, light);  // light.glsl
PLANE_OUT(4, statistics);
layout(push_constant) uniform Push { uint count; } push;

const uint kSumLanes = 64u;  // of the workgroup
shared vec4 sums[3u * kSumLanes];

void main() {
  uint lane = gl_LocalInvocationID.x, lanes = gl_WorkGroupSize.x;
  vec4 intensity = vec4(0.0), chromatic = vec4(0.0), plain = vec4(0.0);
  for (uint i = lane; i < push.count; i += lanes) {
    intensity += FETCH(intensity_sums, int(i));
    chromatic += FETCH(chromatic_sums, int(i));
    plain += FETCH(plain_sums, int(i));
  }
  sums[lane] = intensity;
  sums[lanes + lane] = chromatic;
  sums[2u * lanes + lane] = plain;
  barrier();
  if (lane > 0u) return;
  for (uint i = 1u; i < lanes; ++i) {
    intensity += sums[i];
    chromatic += sums[lanes + i];
    plain += sums[2u * lanes + i];
  }
  intensity.x += 1e-6;
  chromatic.xz += vec2(0.02 * 0.1, 0.02);
  float slope = kColored ? min(abs(FETCH(light, LIGHT_NOW).x), 1.0) : 0.0;
  STORE(statistics, STATISTICS_MEAN, vec4(intensity.y / intensity.x, slope, 0.0, 0.0));
  STORE(statistics, STATISTICS_SIGMAS,
        vec4(log(chromatic.x / chromatic.z + 0.01) + 2.0, 4.0 * chromatic.y / chromatic.z - 2.0, 5.0 * intensity.z / intensity.x - 1.5,
             log(plain.x / (plain.y + 1e-6) + 0.003) + 3.0));
}
