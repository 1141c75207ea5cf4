// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/chapter5/energy/terms.glsl"
#define TABLE_SLOT 0
#include "thesis/chapter5/energy/table.glsl"

// The system of a Gauss-Newton step at x: nodes, diagonal M, z = M⁻¹b with partial sums of zᵀb, and a copy of x that the
// step will be added to.
PLANE_IN(1, state);
PLANE_IN(2, image);
PLANE_IN(3, features);
PLANE_IN(4, sources);
PLANE_OUT(5, nodes);
PLANE_OUT(6, diagonals);
PLANE_OUT(7, preconditioned);
PLANE_OUT(8, next);
PLANE_OUT(9, partials);

int w, plane, n, left, right, above, below;
bool inside;
float sum = 0.0;

/// Adds an edge to b and M. A pixel across the border is the pixel itself: it adds nothing to b, and must not count in M.
void add_edge(int group, int base, vec4 x, int neighbor, inout vec4 b, inout vec4 m) {
  vec4 d = x - FETCH(state, base + neighbor);
  vec4 weight = float(neighbor != n) * edge_weight(group, d);
  m += weight;
  b -= weight * d;
}

/// One plane of the field: `b` and `m` without what differences to the neighbors and local weights add.
void finish(int group, vec4 x, vec4 exists, vec4 b, vec4 m) {
  int base = group * plane;
  vec4 local = local_weight(group, x, exists);
  m += local;
  b -= local * x;
  add_edge(group, base, x, left, b, m);
  add_edge(group, base, x, right, b, m);
  add_edge(group, base, x, above, b, m);
  add_edge(group, base, x, below, b, m);
  vec4 z = precondition(m, b);
  if (inside) {
    STORE(diagonals, base + n, m);
    STORE(preconditioned, base + n, z);
    STORE(next, base + n, x);
    sum += dot(z, b);
  }
}

void main() {
  w = push.size.x;
  plane = w * push.size.y;
  inside = gl_GlobalInvocationID.x < uint(w);
  ivec2 at = ivec2(min(gl_GlobalInvocationID.x, uint(w - 1)), gl_GlobalInvocationID.y);
  n = at.y * w + at.x;
  left = at.x > 0 ? n - 1 : n;
  right = at.x + 1 < w ? n + 1 : n;
  above = at.y > 0 ? n - w : n;
  below = at.y + 1 < push.size.y ? n + w : n;

  vec4 x = FETCH(state, n);
  vec3 s = vec3(x.w);
  for (int g = 1; g <= kGroups; ++g) s += (base_colors(g) * FETCH(state, g * plane + n)).rgb;
  vec3 reflectance = exp(x.rgb);
  vec3 product = reflectance * s;
  vec3 e = FETCH(image, n).rgb - product;
  vec4 source = FETCH(sources, n);
  float monochrome = FETCH(features, n).z;
  vec3 shading_residual = push.lambda_data * e * reflectance - monochrome * colored(s);
  vec3 stiffness = push.lambda_data * reflectance * reflectance;
  if (inside) {
    STORE(nodes, n, vec4(reflectance, monochrome));
    STORE(nodes, plane + n, vec4(product, source.w));
  }
  finish(0, x, vec4(1.0), vec4(push.lambda_data * e * product + source.rgb - source.w * x.rgb, sum3(shading_residual)),
         vec4(push.lambda_data * product * product + source.w, sum3(stiffness)));
  for (int g = 1; g <= kGroups; ++g) {
    mat4 b = base_colors(g);
    mat4 squared = matrixCompMult(b, b);
    vec4 total = vec4(1.0, 1.0, 1.0, 0.0) * b;
    vec4 tint = max(vec4(1.0, 1.0, 1.0, 0.0) * squared - total * total * (1.0 / 3.0), 0.0);
    finish(g, FETCH(state, g * plane + n), vec4(b[0].w, b[1].w, b[2].w, b[3].w), vec4(shading_residual, 0.0) * b,
           vec4(stiffness, 0.0) * squared + monochrome * tint);
  }
  SUM_PARTIALS(partials, vec4(sum, 0.0, 0.0, 0.0));
}
