// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// The triangles of a group: three edge functions each, and bounding boxes. A point is inside if all three a x + b y + c
// are positive; they are proportional to the barycentric weights. Record of a triangle: three times (a, b, c, z of the
// opposite corner), then the corner indices.
PLANE_IN(0, placed);
WORD_IN(1, indices);
PLANE_OUT(2, records);
PLANE_OUT(3, boxes);   // of groups: left, top, right, bottom
PLANE_OUT(4, bounds);  // of triangles: the same
layout(push_constant) uniform Push {
  uint groups;
  uint size;       // triangles of a group
  uint triangles;
} push;

// Triangles extend this far beyond their edges, in pixels, so that rounding leaves no gap between neighbors.
const float kOverlap = 1e-3;

// Computed identically for both triangles of an edge, so that only the sign differs.
vec3 edge(vec2 p, vec2 q) {
  bool turned = q.x < p.x || (q.x == p.x && q.y < p.y);
  vec2 low = turned ? q : p, high = turned ? p : q;
  vec3 e = vec3(low.y - high.y, high.x - low.x, 0.0);
  e.z = -(e.x * low.x + e.y * low.y);
  return turned ? -e : e;
}

void main() {
  uint group = line_index();
  if (group >= push.groups) return;
  vec4 box = vec4(1e9, 1e9, -1e9, -1e9);
  for (uint i = 0u; i < push.size; ++i) {
    uint t = group * push.size + i, base = min(t, push.triangles - 1u) * 3u;
    uvec3 corner = uvec3(FETCH1(indices, int(base)), FETCH1(indices, int(base + 1u)), FETCH1(indices, int(base + 2u)));
    vec4 p = FETCH(placed, int(2u * corner.x)), q = FETCH(placed, int(2u * corner.y)), r = FETCH(placed, int(2u * corner.z));
    vec2 u = q.xy - p.xy, v = r.xy - p.xy;
    float area = u.x * v.y - u.y * v.x, side = area < 0.0 ? -1.0 : 1.0;
    vec3 across_p = side * edge(q.xy, r.xy), across_q = side * edge(r.xy, p.xy), across_r = side * edge(p.xy, q.xy);
    across_p.z += kOverlap * (abs(across_p.x) + abs(across_p.y));
    across_q.z += kOverlap * (abs(across_q.x) + abs(across_q.y));
    across_r.z += kOverlap * (abs(across_r.x) + abs(across_r.y));
    // Triangles seen edge-on, with a corner behind the camera, and padding of the last group have no inside.
    bool solid = t < push.triangles && abs(area) > 1e-12 && min(p.w, min(q.w, r.w)) >= 0.0;
    if (!solid) across_p = across_q = across_r = vec3(0.0, 0.0, -1.0);
    STORE(records, 4u * t, vec4(across_p, p.z));
    STORE(records, 4u * t + 1u, vec4(across_q, q.z));
    STORE(records, 4u * t + 2u, vec4(across_r, r.z));
    STORE(records, 4u * t + 3u, vec4(vec3(corner), 0.0));
    vec4 own = vec4(min(p.xy, min(q.xy, r.xy)), max(p.xy, max(q.xy, r.xy))) + vec2(-1e-2, 1e-2).xxyy;
    STORE(bounds, t, solid ? own : vec4(1e9, 1e9, -1e9, -1e9));
    if (solid) box = vec4(min(box.xy, own.xy), max(box.zw, own.zw));
  }
  STORE(boxes, group, box);
}
