// SPDX-License-Identifier: LGPL-2.1-or-later
#include "thesis/chapter3/energy.glsl"
#include "thesis/shared/sample_frames.glsl"

PLANE_IN(6, image);

vec2 sample_feature(int n) {
  vec3 here = FETCH(image, n).rgb;
  return vec2(pack_chromaticity(chromaticity(here)), push.w_non_local * intensity_weight(here));
}
