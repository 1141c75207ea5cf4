// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"

// One level of a picture's pyramid. Level 0 is the picture with its colors multiplied by alpha. Each pixel of a further one
// is the mean of the area of the level before that it covers, in proportion where sides are odd.
layout(constant_id = 1) const bool BASE = false;

PLANE_IN(0, picture);     // linear RGB, alpha; BASE only
PLANE_INOUT(1, pyramid);  // all levels, one behind the other
layout(push_constant) uniform Push {
  uvec2 fine_size, size;
  uint fine_first, first;  // where the levels begin
} push;

// Pixels of a row that a coarse one covers: the first with weight w.x, the last with w.y, others with 1.
struct Cover {
  uint first, last;
  vec2 w;
};
Cover cover(uint at, uint fine, uint coarse) {
  uint from = at * fine, to = from + fine;  // in fine pixels, times `coarse`
  Cover c;
  c.first = from / coarse;
  c.last = (to - 1u) / coarse;
  c.w = vec2((c.first + 1u) * coarse - from, to - c.last * coarse) / float(coarse);
  return c;
}
float weight(Cover c, uint at) {
  return c.first == c.last ? 1.0 : at == c.first ? c.w.x : at == c.last ? c.w.y : 1.0;
}

void main() {
  uint n = line_index();
  if (n >= push.size.x * push.size.y) return;
  if (BASE) {
    vec4 texel = finite(FETCH(picture, int(n)));
    float alpha = min(texel.a, 1.0);
    STORE(pyramid, push.first + n, vec4(min(texel.rgb, vec3(kLargest)) * alpha, alpha));
    return;
  }
  Cover across = cover(n % push.size.x, push.fine_size.x, push.size.x);
  Cover down = cover(n / push.size.x, push.fine_size.y, push.size.y);
  vec4 sum = vec4(0.0);
  float total = 0.0;
  for (uint y = down.first; y <= down.last; ++y)
    for (uint x = across.first; x <= across.last; ++x) {
      float w = weight(across, x) * weight(down, y);
      sum += w * LOAD(pyramid, push.fine_first + y * push.fine_size.x + x);
      total += w;
    }
  STORE(pyramid, push.first + n, sum / total);
}
