// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"
#include "terms.glsl"
#define TABLE_SLOT 0
#include "table.glsl"

// The terms of the energy at x but for the samples: partial sums of (data, clusters, sparse r, 0) and of (gray shading,
// sparse light, piecewise light, positive light). The norms are smooth near zero, as the weights of the steps are.
PLANE_IN(1, state);
PLANE_IN(2, image);
PLANE_IN(3, targets);
PLANE_IN(4, features);
PLANE_OUT(5, first_partials);
PLANE_OUT(6, second_partials);

float total(vec4 v) { return v.x + v.y + v.z + v.w; }

/// √(v² + ε²) − ε without cancellation.
vec4 smooth_abs(vec4 v) { return v * v / (sqrt(v * v + push.epsilon * push.epsilon) + push.epsilon); }

vec4 negativity(vec4 light) {
  vec4 t = max(-light, 0.0);
  return t - push.epsilon * log(1.0 + t / push.epsilon);
}

float r_norm(vec3 d) {
  float floor2 = push.epsilon_r * push.epsilon_r;
  return pow(dot(d, d) + floor2, 0.5 * push.p) - pow(floor2, 0.5 * push.p);
}

void main() {
  int w = push.size.x;
  int plane = w * push.size.y;
  ivec2 at = ivec2(min(gl_GlobalInvocationID.x, uint(w - 1)), gl_GlobalInvocationID.y);
  int n = at.y * w + at.x;
  int right = at.x + 1 < w ? n + 1 : n;
  int below = at.y + 1 < push.size.y ? n + w : n;
  vec4 x = FETCH(state, n);
  vec4 across = x - FETCH(state, right), down = x - FETCH(state, below);
  float sparse_r = 2.0 * push.lambda_r_sparsity * (r_norm(across.rgb) + r_norm(down.rgb));
  float sparse = 0.0;
  float piecewise = smooth_abs(across).w + smooth_abs(down).w;
  float negative = negativity(x).w;
  vec3 s = vec3(x.w);
  for (int g = 1; g <= kGroups; ++g) {
    vec4 light = FETCH(state, g * plane + n);
    s += (base_colors(g) * light).rgb;
    sparse += total(smooth_abs(light));
    piecewise += total(smooth_abs(light - FETCH(state, g * plane + right)) +
                       smooth_abs(light - FETCH(state, g * plane + below)));
    negative += total(negativity(light));
  }
  vec3 e = FETCH(image, n).rgb - exp(x.rgb) * s;
  vec4 target = FETCH(targets, n);
  vec3 off_target = x.rgb - target.rgb;
  vec3 tint = colored(s);
  float inside = float(gl_GlobalInvocationID.x < uint(w));
  SUM_PARTIALS(first_partials, inside * vec4(push.lambda_data * dot(e, e), target.w * dot(off_target, off_target), sparse_r, 0.0));
  SUM_PARTIALS(second_partials,
               inside * vec4(FETCH(features, n).z * dot(tint, tint), push.lambda_i_sparsity * sparse,
                             push.lambda_smoothness * piecewise, push.lambda_non_negativity * negative));
}
