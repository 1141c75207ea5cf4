// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/chapter5/energy/terms.glsl"
#include "thesis/shared/packed_chromaticity.glsl"

// Per-frame constants: features (packed chromaticity, 1 − w_intensity (1 − |I|), λ_monochrome w_SR, slot
// of the cluster whose center is the nearest in ln c, −1 if there are none).
PLANE_IN(0, image);
#define TABLE_SLOT 1
#include "thesis/chapter5/energy/table.glsl"
PLANE_OUT(2, features);

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int w = push.size.x;
  int n = at.y * w + at.x;
  vec3 here = FETCH(image, n).rgb;
  vec3 c = chromaticity(here);
  vec3 left = chromaticity(FETCH(image, at.x > 0 ? n - 1 : n).rgb) - c;
  vec3 right = chromaticity(FETCH(image, at.x + 1 < w ? n + 1 : n).rgb) - c;
  vec3 above = chromaticity(FETCH(image, at.y > 0 ? n - w : n).rgb) - c;
  vec3 below = chromaticity(FETCH(image, at.y + 1 < push.size.y ? n + w : n).rgb) - c;
  float step = sqrt(max(max(dot(left, left), dot(right, right)), max(dot(above, above), dot(below, below))));

  vec3 log_c = log(c);
  int cluster = -1;
  float best = 0.0;
  for (int k = 0; k < push.centers; ++k) {
    vec4 own = center(k);
    vec3 d = log_c - own.rgb;
    float distance = dot(d, d);
    bool nearer = own.w > 0.0 && (cluster < 0 || distance < best);
    cluster = nearer ? k : cluster;
    best = nearer ? distance : best;
  }
  STORE(features, n, vec4(pack_chromaticity(c), intensity_weight(here),
                          push.lambda_monochrome * (1.0 - exp(-push.alpha_sr * step)), float(cluster)));
}
