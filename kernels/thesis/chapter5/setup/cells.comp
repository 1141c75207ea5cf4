// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#include "thesis/chapter5/energy/terms.glsl"

// For scene cuts: the mean of ln c in each of 32 x 32 parts of the frame, of up to 16 of its pixels, and how much
// light is there, into half `slot` of `cells`. One part an invocation.
PLANE_IN(0, chroma);
PLANE_IN(1, image);
PLANE_OUT(2, cells);

const int kAcross = 32;
const int kSide = 4;       // pixels read, along an axis
const float kDark = 0.01;  // below it, color is noise

void main() {
  int i = int(gl_GlobalInvocationID.x);
  if (i >= kAcross * kAcross) return;
  ivec2 cell = ivec2(i % kAcross, i / kAcross);
  ivec2 first = cell * push.size / kAcross;
  ivec2 span = max((cell + 1) * push.size / kAcross - first, ivec2(1));
  ivec2 count = min(span, ivec2(kSide));
  vec4 sum = vec4(0.0);
  for (int y = 0; y < count.y; ++y)
    for (int x = 0; x < count.x; ++x) {
      ivec2 at = first + (2 * ivec2(x, y) + 1) * span / (2 * count);
      int n = at.y * push.size.x + at.x;
      float light = mean3(FETCH(image, n).rgb);
      sum += vec4(FETCH(chroma, n).rgb, light > kDark ? min(light, 1.0) : 0.0);
    }
  STORE(cells, push.slot * kAcross * kAcross + i, sum / float(count.x * count.y));
}
