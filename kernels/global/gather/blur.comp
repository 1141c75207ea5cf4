// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "global/model/model.glsl"

// Blurs light of every base color along one axis with a Gaussian; beyond the border there is none.
layout(constant_id = 1) const bool kDown = false;
PLANE_IN(0, emitted);
PLANE_IN(1, means);
SCALAR_IN(2, taps);  // of distances 0, 1, …; they sum to 1 with their mirror images
PLANE_OUT(3, blurred);
layout(push_constant) uniform Push {
  SIZES
  int reach;
} push;

void main() {
  int i = int(line_index()), count = push.coarse.x * push.coarse.y, slot = i / count;
  if (slot >= kSlots) return;
  vec4 sum = vec4(0.0);
  if (FETCH(means, slot).w > 0.0) {
    int j = i - slot * count, y = j / push.coarse.x, x = j - y * push.coarse.x;
    int here = kDown ? y : x, last = (kDown ? push.coarse.y : push.coarse.x) - 1, step = kDown ? push.coarse.x : 1;
    for (int at = max(here - push.reach, 0); at <= min(here + push.reach, last); ++at)
      sum += FETCH1(taps, abs(at - here)) * FETCH(emitted, i + (at - here) * step);
  }
  STORE(blurred, i, sum);
}
