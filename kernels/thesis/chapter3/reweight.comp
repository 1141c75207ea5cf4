// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "energy.glsl"

// The system of an IRLS step at x: edges and node, and z = M⁻¹(b − A x), with partial sums of zᵀ(b − A x).
PLANE_IN(0, solution);
PLANE_IN(1, links);
PLANE_IN(2, sources);
PLANE_IN(3, image);
PLANE_OUT(4, edges);
PLANE_OUT(5, nodes);
PLANE_OUT(6, preconditioned);
PLANE_OUT(7, partials);
#define STROKE_BINDING 8
#include "thesis/chapter4/strokes.glsl"

const int kStrip = 8;

/// (a, V) of an edge from its constant part and the difference of solutions across it.
vec2 weigh(vec2 link, vec4 difference) { return vec2(link.x * irls_weight(difference.rgb), link.y); }

void main() {
  int w = push.size.x;
  int x = min(int(gl_GlobalInvocationID.x), w - 1);
  int first = int(gl_GlobalInvocationID.y) * kStrip;
  bool inside = int(gl_GlobalInvocationID.x) < w;
  int left = max(x - 1, 0);
  int right = min(x + 1, w - 1);
  float has_left = float(x > 0);
  float sum = 0.0;

  int before = max(first - 1, 0) * w + x;
  vec4 here = FETCH(solution, first * w + x);
  vec4 up = here - FETCH(solution, before);
  vec2 edge_up = float(first > 0) * weigh(FETCH(links, before).yw, up);
  for (int row = 0; row < kStrip; ++row) {
    int y = first + row;
    int base = min(y, push.size.y - 1) * w;
    int n = base + x;
    vec4 below = FETCH(solution, min(y + 1, push.size.y - 1) * w + x);
    vec4 link = FETCH(links, n);
    vec4 across = here - FETCH(solution, base + right);
    vec4 down = here - below;
    vec4 back = here - FETCH(solution, base + left);
    vec2 edge_right = weigh(link.xz, across);
    vec2 edge_down = weigh(link.yw, down);
    vec2 edge_left = has_left * weigh(FETCH(links, base + left).xz, back);

    vec4 source = FETCH(sources, n);
    StrokeTarget target = stroke_target(x, min(y, push.size.y - 1));
    vec4 held = target.weight * (target.reflectance ? vec4(1.0, 1.0, 1.0, 0.0) : vec4(0.0, 0.0, 0.0, 1.0));
    vec3 light = FETCH(image, n).rgb;
    vec2 total = edge_right + edge_down + edge_left + edge_up;
    vec4 node = vec4(local_weight(light), source.w + held.r, total + vec2(0.0, held.a));
    // All of differences: what rounding leaves is small against what is left to do, not against b or A x.
    vec4 residual = node_residual(node, log_light(light), here) + vec4(source.rgb - source.w * here.rgb, 0.0) +
                    held * (target.value.rgbr - here) -
                    (edge_right.xxxy * across + edge_down.xxxy * down + edge_left.xxxy * back + edge_up.xxxy * up);
    vec4 z = precondition(diagonal(node), residual);
    if (inside && y < push.size.y) {
      STORE(edges, n, vec4(edge_right.x, edge_down.x, edge_right.y, edge_down.y));
      STORE(nodes, n, node);
      STORE(preconditioned, n, z);
      sum += dot(z, residual);
    }
    edge_up = edge_down;
    up = -down;
    here = below;
  }
  SUM_PARTIALS(partials, vec4(sum, 0.0, 0.0, 0.0));
}
