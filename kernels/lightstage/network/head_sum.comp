// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// The subject under lights by the network, Σ weight P, and under the measured light (MeasuredLight):
//
//     F (even + Σ_k along_k m_k),   m_k = D_k F_k / (F_k² + noise²),   F = A + B, D = A - B
PLANE_IN(0, full);
PLANE_IN(1, features);  // a value of 64 channels (network/value.glsl)
PLANE_IN(2, head_weights);
PLANE_IN(3, lights);
PLANE_IN(4, difference);  // D
PLANE_OUT(5, picture);
layout(push_constant) uniform Push {
  vec4 even;      // w = noise²
  vec4 along[3];
  uvec2 size;    // of the frame
  uvec2 padded;  // of the features
  int lights;    // a multiple of four
} push;

#include "light_head.glsl"

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x) return;
  uint i = at.y * push.size.x + at.x;
  int from = int(1u + at.y * push.padded.x + at.x), area = int(push.padded.x * push.padded.y);
  vec4 f[16];
  for (int k = 0; k < kBlocks; ++k) f[k] = FETCH(features, from + k * area);
  vec4 all = FETCH(full, int(i));
  vec3 sum = vec3(0.0), pa, pb, pc, pd;
  for (int k = 0; k < push.lights; k += 4) {
    light_head(f, all.rgb, k, pa, pb, pc, pd);
    int l = k * kLightSize + 1;
    sum += pa * FETCH(lights, l).rgb + pb * FETCH(lights, l + kLightSize).rgb +
           pc * FETCH(lights, l + 2 * kLightSize).rgb + pd * FETCH(lights, l + 3 * kLightSize).rgb;
  }
  vec3 m = FETCH(difference, int(i)).rgb * all.rgb / (all.rgb * all.rgb + push.even.w);
  vec3 measured = push.even.rgb + m.x * push.along[0].rgb + m.y * push.along[1].rgb + m.z * push.along[2].rgb;
  STORE(picture, i, vec4(max(sum + all.rgb * measured, 0.0), all.w));
}
