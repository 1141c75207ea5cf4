#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "energy.glsl"
#include "terms.glsl"
#define TABLE_SLOT 0
#include "table.glsl"

// First half of a conjugate-gradient iteration: d = z + β d₀, q = A d, with partial sums of dᵀq and dᵀM d.
PLANE_IN(1, preconditioned);
PLANE_IN(2, previous);
PLANE_IN(3, state);
PLANE_IN(4, nodes);
PLANE_IN(5, diagonals);
SCALAR_IN(6, scalars);
PLANE_OUT(7, directions);
PLANE_OUT(8, products);
PLANE_OUT(9, partials);

const int kStrip = 4;

int w, h, plane, x, first, left, right;
bool inside;
float beta;
vec3 force[kStrip];  // on the shading, b_k · force on layer k
vec3 on_r[kStrip];
vec2 sum = vec2(0.0);

vec4 search(int n) {
  vec4 before = FETCH(previous, n);
  return FETCH(preconditioned, n) + (beta != 0.0 ? beta * before : vec4(0.0));
}

int row_start(int row) { return min(first + row, h - 1) * w; }

/// One plane of the field, along the strip.
void finish(int group, mat4 colors, vec4 exists) {
  int base = group * plane;
  int above = base + max(first - 1, 0) * w + x;
  vec4 here = search(base + first * w + x);
  vec4 at = FETCH(state, base + first * w + x);
  vec4 up = edge_weight(group, at - FETCH(state, above)) * (here - search(above));
  for (int row = 0; row < kStrip; ++row) {
    int start = base + row_start(row);
    int n = start + x;
    int below = base + row_start(row + 1) + x;
    vec4 here_below = search(below);
    vec4 at_below = FETCH(state, below);
    vec4 down = edge_weight(group, at - at_below) * (here - here_below);
    vec4 q = up + down + edge_weight(group, at - FETCH(state, start + left)) * (here - search(start + left)) +
             edge_weight(group, at - FETCH(state, start + right)) * (here - search(start + right)) +
             local_weight(group, at, exists) * here;
    q += group == 0 ? vec4(on_r[row], sum3(force[row])) : vec4(force[row], 0.0) * colors;
    if (inside && first + row < h) {
      STORE(directions, n, here);
      STORE(products, n, q);
      sum += vec2(dot(here, q), dot(here, FETCH(diagonals, n) * here));
    }
    up = -down;
    here = here_below;
    at = at_below;
  }
}

void main() {
  w = push.size.x;
  h = push.size.y;
  plane = w * h;
  inside = gl_GlobalInvocationID.x < uint(w);
  x = int(min(gl_GlobalInvocationID.x, uint(w - 1)));
  first = int(gl_GlobalInvocationID.y) * kStrip;
  left = max(x - 1, 0);
  right = min(x + 1, w - 1);
  beta = FETCH1(scalars, 2);

  for (int row = 0; row < kStrip; ++row) force[row] = vec3(search(row_start(row) + x).w);
  for (int g = 1; g <= kGroups; ++g) {
    mat4 b = base_colors(g);
    for (int row = 0; row < kStrip; ++row) force[row] += (b * search(g * plane + row_start(row) + x)).rgb;
  }
  for (int row = 0; row < kStrip; ++row) {
    int n = row_start(row) + x;
    vec4 reflectance = FETCH(nodes, n);
    vec4 product = FETCH(nodes, plane + n);
    vec3 dr = search(n).rgb;
    vec3 change = push.lambda_data * (product.rgb * dr + reflectance.rgb * force[row]);
    on_r[row] = product.rgb * change + product.w * dr;
    force[row] = reflectance.rgb * change + reflectance.w * colored(force[row]);
  }
  finish(0, mat4(0.0), vec4(1.0));
  for (int g = 1; g <= kGroups; ++g) {
    mat4 b = base_colors(g);
    finish(g, b, vec4(b[0].w, b[1].w, b[2].w, b[3].w));
  }
  SUM_PARTIALS(partials, vec4(sum, 0.0, 0.0));
}
