// SPDX-License-Identifier: LGPL-2.1-or-later
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/shared/sample_frames.glsl"

PLANE_IN(6, features);

vec2 sample_feature(int n) {
  vec4 feature = FETCH(features, n);
  return vec2(feature.x, push.lambda_r_consistency * feature.y);
}
