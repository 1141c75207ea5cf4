#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "guide.glsl"
#include "quad.glsl"
#include "temporal.glsl"

// How far every cell differs from the frame before, q: squared differences, in units of those that halve the anchor, of
// its local contrast and chroma, and the variance of its pixels' change, which a change of light leaves alone. One cell an
// invocation.
PLANE_IN(0, cells);
PLANE_IN(1, wide);
PLANE_IN(2, level0);
PLANE_IN(3, before);   // cell_state
PLANE_IN(4, before_m);  // of quads of pixels
PLANE_OUT(5, mismatch);
layout(push_constant) uniform Push {
  uvec2 size;  // of level 0
  float detail;
  float chroma;
  float texture;
  float trust;
} push;

void main() {
  uvec2 cell_size = ((push.size + 1u) / 2u + 1u) / 2u, cell = grid_position(cell_size.x);
  if (cell.y >= cell_size.y) return;
  uvec2 first = 4u * cell, count = min(push.size - first, uvec2(4u));
  float sum = 0.0, squares = 0.0, now = 0.0, nows = 0.0, then = 0.0, thens = 0.0, share = 1.0 / float(count.x * count.y);
  for (uint y = first.y; y < first.y + count.y; ++y) {
    vec4 was = FETCH(before_m, 2 * int(y * cell_size.x + cell.x));
    for (uint x = 0u; x < count.x; ++x) {
      float m = FETCH(level0, int(y * push.size.x + first.x + x)).x, change = m - was.x;
      now += m; nows += m * m; then += was.x; thens += was.x * was.x;
      was = was.yzwx;
      sum += change;
      squares += change * change;
    }
  }
  uint at = cell.y * cell_size.x + cell.x;
  vec4 around = FETCH(wide, int((cell.y / 4u) * QUADS(cell_size.x) + cell.x / 4u));
  vec4 step = cell_state(FETCH(cells, int(CELL_STRIDE * at)), around) - FETCH(before, int(at));
  float light = exp(FETCH(cells, int(CELL_STRIDE * at)).x), t = mix(1.0, light / (light + 0.02), push.trust);
  step.yz *= t;
  step *= vec4(push.detail, push.chroma, push.chroma, 0.0);
  float mean = share * sum;
  float q = dot(step, step) + push.texture * push.texture * max(share * squares - mean * mean, 0.0);
  float d = max(share * squares - mean * mean, 0.0);
  now *= share; then *= share;
  float e = max(share * nows - now * now, 0.0) + max(share * thens - then * then, 0.0);
  float w = e / (e + 0.02);
  STORE(mismatch, at, vec4(q, w * d, w * e, 0.0));
}
