// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "lobe.glsl"

// Response of some pixels of the frame to each light of the stage; light_reduction.cpp selects lights from them.
PLANE_IN(0, full);
PLANE_IN(1, lobes);
PLANE_IN(2, lobe_values);      // w = 1/S(u, p)
PLANE_IN(3, lights);    // by twos: direction; unused
WORD_IN(4, samples);    // their pixels
PLANE_OUT(5, response); // sample by sample, light by light
layout(push_constant) uniform Push {
  uint samples;
  uint lights;
} push;

#include "lobe_table.glsl"

void main() {
  uint i = line_index();
  if (i >= push.samples * push.lights) return;
  uint k = i / push.lights;
  int light = int(i - k * push.lights), pixel = int(FETCH1(samples, int(k)));
  vec4 f = FETCH(full, pixel), lobe = FETCH(lobes, pixel);
  float share = length(lobe.xyz);
  vec3 u = share > 1e-6 ? lobe.xyz / share : vec3(0.0, 0.0, 1.0);
  float given = lobe_at(dot(FETCH(lights, 2 * light).xyz, u), lobe.w) * lobe_table(u, lobe.w).w;
  STORE(response, i, vec4(f.rgb * mix(1.0 / float(push.lights), given, min(share, 1.0)), 0.0));
}
