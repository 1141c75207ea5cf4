// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/chapter5/energy/terms.glsl"
#define TABLE_SLOT 0
#include "thesis/chapter5/energy/table.glsl"

// q = A d, with partial sums of dᵀq and dᵀM d. The dispatch's z is the plane of the field.
PLANE_IN(1, directions);
PLANE_IN(2, state);
PLANE_IN(3, pixel_products);
PLANE_IN(4, diagonals);
PLANE_OUT(5, products);
PLANE_OUT(6, partials);

const int kStrip = 8;

void main() {
  int w = push.size.x, h = push.size.y, plane = w * h;
  int group = int(gl_WorkGroupID.z);
  int base = group * plane;
  int shared_at = min(group, 1) * plane;  // in `pixel_products`
  bool inside = int(gl_GlobalInvocationID.x) < w;
  int x = min(int(gl_GlobalInvocationID.x), w - 1);
  int first = int(gl_GlobalInvocationID.y) * kStrip;
  int left = max(x - 1, 0), right = min(x + 1, w - 1);
  mat4 colors = base_colors(max(group, 1));
  vec4 exists = vec4(colors[0].w, colors[1].w, colors[2].w, colors[3].w);
  // Those of plane 0 are stored without base colors.
  if (group == 0) colors = mat4(1.0);
  vec2 sum = vec2(0.0);

  int above = base + max(first - 1, 0) * w + x;
  vec4 here = FETCH(directions, base + first * w + x);
  vec4 at = FETCH(state, base + first * w + x);
  vec4 up = edge_weight(group, at - FETCH(state, above)) * (here - FETCH(directions, above));
  for (int row = 0; row < kStrip; ++row) {
    int y = first + row;
    int start = min(y, h - 1) * w;
    int n = base + start + x;
    int below = base + min(y + 1, h - 1) * w + x;
    vec4 here_below = FETCH(directions, below);
    vec4 at_below = FETCH(state, below);
    vec4 down = edge_weight(group, at - at_below) * (here - here_below);
    vec4 back = edge_weight(group, at - FETCH(state, base + start + left)) *
                (here - FETCH(directions, base + start + left));
    vec4 across = edge_weight(group, at - FETCH(state, base + start + right)) *
                  (here - FETCH(directions, base + start + right));
    vec4 q = FETCH(pixel_products, shared_at + start + x) * colors + local_weight(group, at, exists) * here + up + down + back +
             across;
    if (inside && y < h) {
      STORE(products, n, q);
      sum += vec2(dot(here, q), dot(here, FETCH(diagonals, n) * here));
    }
    up = -down;
    here = here_below;
    at = at_below;
  }
  SUM_PARTIALS(partials, vec4(sum, 0.0, 0.0));
}
