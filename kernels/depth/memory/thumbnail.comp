// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// A frame in 16 x 12 cells: means of ln brightness and of the depth that is known. One cell an invocation.
const uint kThumbnailWidth = 16u, kThumbnailHeight = 12u;
SCALAR_IN(0, brightness);
SCALAR_IN(1, depth);
PLANE_OUT(2, thumbnail);  // ln brightness, meters (0: unknown), -, -
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint cell = line_index();
  if (cell >= kThumbnailWidth * kThumbnailHeight) return;
  uvec2 at = uvec2(cell % kThumbnailWidth, cell / kThumbnailWidth), cells = uvec2(kThumbnailWidth, kThumbnailHeight);
  uvec2 low = at * push.size / cells, high = max((at + 1u) * push.size / cells, low + 1u);
  vec4 sum = vec4(0.0);
  for (uint y = low.y; y < min(high.y, push.size.y); ++y)
    for (uint x = low.x; x < min(high.x, push.size.x); ++x) {
      int pixel = int(y * push.size.x + x);
      float z = FETCH1(depth, pixel);
      bool known = z > 0.0;
      sum += vec4(FETCH1(brightness, pixel), known ? z : 0.0, known ? 1.0 : 0.0, 1.0);
    }
  STORE(thumbnail, cell, vec4(sum.x / max(sum.w, 1.0), sum.z > 0.0 ? sum.y / sum.z : 0.0, 0.0, 0.0));
}
