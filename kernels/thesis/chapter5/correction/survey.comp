// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// A smaller frame, in which the host searches for misclustered regions: of each `factor`² pixels the mean color of those
// that have the cluster of the middle one, so that no color is mixed across a border, and, of the middle one, its cluster + 1
// (0: none) and kClusterCodes times the number of the marked region that it is in.
layout(push_constant) uniform Push {
  ivec2 size;
  ivec2 fine_size;
  int factor;
} push;
PLANE_IN(0, image);
PLANE_IN(1, features);
PLANE_IN(2, regions);
PLANE_OUT(3, survey);

const int kClusterCodes = 32;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  ivec2 first = at * push.factor;
  ivec2 middle = min(first + push.factor / 2, push.fine_size - 1);
  int m = middle.y * push.fine_size.x + middle.x;
  float cluster = FETCH(features, m).w;
  vec4 sum = vec4(0.0);
  for (int y = first.y; y < min(first.y + push.factor, push.fine_size.y); ++y)
    for (int x = first.x; x < min(first.x + push.factor, push.fine_size.x); ++x) {
      int n = y * push.fine_size.x + x;
      sum += FETCH(features, n).w == cluster ? vec4(FETCH(image, n).rgb, 1.0) : vec4(0.0);
    }
  float code = cluster + 1.0 + float(kClusterCodes) * FETCH(regions, m).y;
  STORE(survey, at.y * push.size.x + at.x, vec4(sum.rgb / sum.w, code));
}
