// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/chapter5/energy/terms.glsl"
#include "thesis/shared/scalars.glsl"
#define TABLE_SLOT 0
#include "thesis/chapter5/energy/table.glsl"

// A conjugate-gradient iteration begins: d = z + β d, in place, and what all unknowns of a pixel share of A d, through the
// data term and gray shading: the product for r, and that for the shading, of which layer k gets the dot product with b_k.
PLANE_IN(1, preconditioned);
PLANE_IN(2, previous);
PLANE_IN(3, nodes);
SCALAR_IN(4, scalars);
PLANE_OUT(5, directions);
PLANE_OUT(6, pixel_products);

float beta;

vec4 search(int n) {
  vec4 before = FETCH(previous, n);
  return FETCH(preconditioned, n) + (beta != 0.0 ? beta * before : vec4(0.0));
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int plane = push.size.x * push.size.y;
  int n = at.y * push.size.x + at.x;
  beta = FETCH1(scalars, CG_BETA);
  vec4 reflectance = FETCH(nodes, n);
  vec4 product = FETCH(nodes, plane + n);
  vec4 first = search(n);
  vec3 light = vec3(first.w);
  STORE(directions, n, first);
  for (int g = 1; g <= kGroups; ++g) {
    vec4 d = search(g * plane + n);
    STORE(directions, g * plane + n, d);
    light += (base_colors(g) * d).rgb;
  }
  vec3 change = push.lambda_data * (product.rgb * first.rgb + reflectance.rgb * light);
  vec3 shading = reflectance.rgb * change + reflectance.w * colored(light);
  STORE(pixel_products, n, vec4(product.rgb * change + product.w * first.rgb, sum3(shading)));
  STORE(pixel_products, plane + n, vec4(shading, 0.0));
}
