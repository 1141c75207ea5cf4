// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Response of some pixels of the frame to each light, as respond.comp, by the network.
PLANE_IN(0, full);
PLANE_IN(1, features);
PLANE_IN(2, head_weights);
PLANE_IN(3, lights);
WORD_IN(4, samples);
PLANE_OUT(5, response);
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 padded;
  uint lights;   // what goes out a sample
  uint fours;    // (lights + 3) / 4
  uint samples;
} push;

#include "light_head.glsl"

void main() {
  uint i = line_index();
  if (i >= push.samples * push.fours) return;
  uint sample_index = i / push.fours, k = 4u * (i - sample_index * push.fours);
  uint pixel = FETCH1(samples, int(sample_index)), y = pixel / push.size.x;
  int from = int(1u + y * push.padded.x + (pixel - y * push.size.x)), area = int(push.padded.x * push.padded.y);
  vec4 f[16];
  for (int b = 0; b < kBlocks; ++b) f[b] = FETCH(features, from + b * area);
  vec3 pa, pb, pc, pd;
  light_head(f, FETCH(full, int(pixel)).rgb, int(k), pa, pb, pc, pd);
  int l = int(k) * kLightSize + 1;
  uint to = sample_index * push.lights + k;
  STORE(response, to, vec4(pa * FETCH(lights, l).rgb, 0.0));
  if (k + 1u < push.lights) STORE(response, to + 1u, vec4(pb * FETCH(lights, l + kLightSize).rgb, 0.0));
  if (k + 2u < push.lights) STORE(response, to + 2u, vec4(pc * FETCH(lights, l + 2 * kLightSize).rgb, 0.0));
  if (k + 3u < push.lights) STORE(response, to + 3u, vec4(pd * FETCH(lights, l + 3 * kLightSize).rgb, 0.0));
}
