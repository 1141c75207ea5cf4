// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "key.glsl"

// The mean light of each cell's pixels that surely show the screen, or (FRONT) that surely do not. w: their share.
layout(constant_id = 1) const bool FRONT = false;
PLANE_IN(0, frame);
PLANE_IN(1, intrinsic);
PLANE_IN(2, screen);
PLANE_IN(3, behind);  // FRONT: light of the screen, on cells
PLANE_OUT(4, means);
layout(push_constant) uniform Push {
  uvec2 size;  // of the frame
  uvec2 cells;
  uint side;
  float tolerance;
} push;

const float kPartly = 0.75, kOpaque = 0.9;

void main() {
  uvec2 cell = gl_GlobalInvocationID.xy;
  if (cell.x >= push.cells.x) return;
  uvec2 first = cell * push.side, last = min(first + push.side, push.size);
  vec4 paint = FETCH(screen, 0), sum = vec4(0.0);
  if (paint.w > 0.0)
    for (uint y = first.y; y < last.y; ++y)
      for (uint x = first.x; x < last.x; ++x) {
        int n = int(y * push.size.x + x);
        vec3 seen = bounded(FETCH(frame, n)).rgb;
        float weight;
        if (FRONT) {
          Place place = place_of(uvec2(x, y), push.cells, 1.0 / float(push.side));
          weight = rising(kPartly, kOpaque, opacity(seen, AROUND(behind, place), vec4(0.0)));
        } else {
          weight = sureness(seen, bounded(FETCH(intrinsic, n)).rgb, paint.rgb, push.tolerance);
        }
        sum += weight * vec4(seen, 1.0);
      }
  float count = float((last.x - first.x) * (last.y - first.y));
  STORE(means, cell.y * push.cells.x + cell.x, sum.w > 1e-4 ? vec4(sum.rgb / sum.w, sum.w / count) : vec4(0.0));
}
