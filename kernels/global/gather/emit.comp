// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"

// For every base color of the frame before, or with kKnown of this frame, the light that its surfaces emit, on the coarse grid:
// mean color and number of their points. All points count to the first color if there were none. One coarse point, 2 x 2 points, an
// invocation.
layout(constant_id = 1) const bool kKnown = false;
PLANE_IN(0, colors);
PLANE_IN(1, scene);
WORD_INOUT(2, labels);
PLANE_OUT(3, emitted);
layout(push_constant) uniform Push { SIZES } push;

void main() {
  int j = int(line_index()), count = push.coarse.x * push.coarse.y;
  if (j >= count) return;
  ivec2 first = 2 * ivec2(j % push.coarse.x, j / push.coarse.x), last = min(first + 2, push.grid);
  bool restart = !kKnown && FETCH(scene, SCENE_TIME)[TIME_FRAMES] < 1.5;
  int label[4];
  vec4 color[4];
  for (int k = 0; k < 4; ++k) {
    ivec2 at = first + ivec2(k & 1, k >> 1);
    label[k] = -1;
    if (at.x < last.x && at.y < last.y) {
      int i = at.y * push.grid.x + at.x;
      if (restart) LOAD(labels, i) = 0u;
      label[k] = int(LOAD(labels, i));
      color[k] = vec4(FETCH(colors, i).rgb, 1.0);
    }
  }
  float share = 1.0 / float((last.x - first.x) * (last.y - first.y));
  for (int slot = 0; slot < kSlots; ++slot) {
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; ++k)
      if (label[k] == slot) sum += color[k];
    STORE(emitted, slot * count + j, share * sum);
  }
}
