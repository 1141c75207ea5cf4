// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "light.glsl"

// The coarser levels of points: means of those of 2 x 2 that there are. One point of them an invocation.
PLANE_IN(0, fine);
PLANE_OUT(1, coarse);  // from level 1 on
layout(push_constant) uniform Push { uvec2 cells; } push;

#define MEAN(name, below, level)                                                                   \
  vec4 name(uvec2 at) {                                                                            \
    uvec2 size = level_size(push.cells, level - 1u);                                               \
    vec4 sum = vec4(0.0);                                                                          \
    float count = 0.0;                                                                             \
    for (uint k = 0u; k < 4u; ++k) {                                                               \
      uvec2 of = 2u * at + uvec2(k & 1u, k >> 1u);                                                 \
      if (of.x >= size.x || of.y >= size.y) continue;                                              \
      sum += below(of);                                                                            \
      count += 1.0;                                                                                \
    }                                                                                              \
    return sum / count;                                                                            \
  }
vec4 mean0(uvec2 at) { return FETCH(fine, int(at.y * push.cells.x + at.x)); }
MEAN(mean1, mean0, 1u)
MEAN(mean2, mean1, 2u)
MEAN(mean3, mean2, 3u)

void main() {
  uint i = line_index(), count = push.cells.x * push.cells.y;
  if (i + count >= level_start(push.cells, uint(LIGHT_LEVELS))) return;
  uint level = i + count >= level_start(push.cells, 3u) ? 3u : i + count >= level_start(push.cells, 2u) ? 2u : 1u;
  uint within = i + count - level_start(push.cells, level);
  uvec2 size = level_size(push.cells, level), at = uvec2(within % size.x, within / size.x);
  vec4 mean;
  if (level == 1u) mean = mean1(at);
  else if (level == 2u) mean = mean2(at);
  else mean = mean3(at);
  STORE(coarse, i, mean);
}
