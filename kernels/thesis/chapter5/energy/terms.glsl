// SPDX-License-Identifier: LGPL-2.1-or-later
// The terms of the energy and their weights, for the kernels that need them.

#include "solve/conjugate_gradients.glsl"

float sum3(vec3 v) { return v.r + v.g + v.b; }
float mean3(vec3 v) { return sum3(v) * (1.0 / 3.0); }
vec3 colored(vec3 v) { return v - mean3(v); }

float intensity_weight(vec3 image) { return 1.0 - push.w_intensity * (1.0 - clamp(mean3(image), 0.0, 1.0)); }

vec3 chromaticity(vec3 image) { return (image + push.chroma_floor) / (mean3(image) + push.chroma_floor); }

vec4 root(vec4 squared) { return inversesqrt(squared + push.epsilon * push.epsilon); }

/// a of the squared difference of two pixels' r.
float r_weight(vec3 difference) {
  float norm = dot(difference, difference) + push.epsilon_r * push.epsilon_r;
  float power = kUnitExponent ? inversesqrt(norm) : pow(norm, 0.5 * push.p - 1.0);
  return 2.0 * push.lambda_r_sparsity * push.irls_r * power;
}

/// v of the squared differences of four layers.
vec4 light_weight(vec4 difference) { return push.lambda_smoothness * push.irls_light * root(difference * difference); }

/// Weights of the squared difference of two pixels in a plane of a field, given by the difference of x.
vec4 edge_weight(int group, vec4 difference) {
  vec4 light = light_weight(difference);
  return group == 0 ? vec4(vec3(r_weight(difference.rgb)), light.w) : light;
}

/// w of T², non-negativity.
vec4 negative_weight(vec4 light) {
  vec4 weight = push.lambda_non_negativity * push.irls_light / (push.epsilon + max(-light, 0.0));
  return mix(weight, vec4(0.0), greaterThan(light, vec4(0.0)));
}

/// w of the unknowns in a plane of a field; `exists` is 1 for layers that have a base color.
vec4 local_weight(int group, vec4 x, vec4 exists) {
  vec4 negative = negative_weight(x);
  return group == 0 ? vec4(vec3(0.0), negative.w)
                    : exists * (negative + push.lambda_i_sparsity * push.irls_light * root(x * x));
}
