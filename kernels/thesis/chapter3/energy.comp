// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// The local terms of the energy at x: partial sums of (data and chromaticity, sparsity, smooth shading, strokes).
PLANE_IN(0, image);
PLANE_IN(1, solution);
PLANE_IN(2, links);
PLANE_OUT(3, partials);
#define STROKE_BINDING 4
#include "thesis/chapter4/strokes.glsl"

vec2 across(vec2 link, vec4 difference) {
  float squared = dot(difference.rgb, difference.rgb) + push.epsilon2;
  return link * vec2(pow(squared, 0.5 * push.p), difference.a * difference.a);
}

void main() {
  ivec2 at = ivec2(min(gl_GlobalInvocationID.x, uint(push.size.x - 1)), gl_GlobalInvocationID.y);
  int n = at.y * push.size.x + at.x;
  vec3 here = FETCH(image, n).rgb;
  vec4 value = FETCH(solution, n);
  vec3 difference = log_light(here) - value.rgb;
  vec3 residual = difference - value.a;
  vec3 chroma = difference - mean3(difference);
  float local = local_weight(here) * (push.w_data * dot(channel_weight(), residual * residual) +
                                      push.w_chromaticity * dot(chroma, chroma));
  vec4 link = FETCH(links, n);
  vec2 edges = across(link.xz, value - FETCH(solution, at.x + 1 < push.size.x ? n + 1 : n)) +
               across(link.yw, value - FETCH(solution, at.y + 1 < push.size.y ? n + push.size.x : n));
  StrokeTarget target = stroke_target(at.x, at.y);
  vec3 off = target.reflectance ? value.rgb - target.value : vec3(value.a - target.value.x, 0.0, 0.0);
  SUM_PARTIALS(partials, gl_GlobalInvocationID.x < uint(push.size.x) ? vec4(local, edges, target.weight * dot(off, off))
                                                                     : vec4(0.0));
}
