#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "model.glsl"

// Labels of the grid's points, by what chroma their tint leaves, and for every base color the light that its surfaces send,
// on the coarse grid: mean color and number of their points. One coarse point, 2 x 2 points, an invocation.
layout(constant_id = 1) const bool kFirst = false;  // no base color is known: all points have the first
PLANE_IN(0, colors);
PLANE_IN(1, points);
PLANE_IN(2, tints);
WORD_IN(3, slots);  // of bins
WORD_OUT(4, labels);
PLANE_OUT(5, emitted);
layout(push_constant) uniform Push { SIZES } push;

void main() {
  int j = int(gl_GlobalInvocationID.x), count = push.coarse.x * push.coarse.y;
  if (j >= count) return;
  ivec2 first = 2 * ivec2(j % push.coarse.x, j / push.coarse.x), last = min(first + 2, push.grid);
  int label[4];
  vec4 color[4];
  for (int k = 0; k < 4; ++k) {
    ivec2 at = first + ivec2(k & 1, k >> 1);
    label[k] = -1;
    if (at.x < last.x && at.y < last.y) {
      int i = at.y * push.grid.x + at.x;
      label[k] = kFirst ? 0 : int(FETCH1(slots, bin_of(FETCH(points, i).xy - FETCH(tints, i).xy)));
      color[k] = vec4(FETCH(colors, i).rgb, 1.0);
      STORE(labels, i, uint(label[k]));
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
