// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"

// Restriction: the right-hand side of every aggregate is the sum of its 2 x 2 residuals, its correction starts at zero. With kFromZero
// `now` is zero, and the residual is the right-hand side. On levels 0 and 1 (kMeans) also computes the aggregates' mean of the current
// s. One coarse pack an invocation.
layout(constant_id = 1) const int kStride = 4;  // of the fine system
layout(constant_id = 2) const int kMeans = 0;   // 0: none; 1: of `now`; 2: of finer means and `now`, its correction
layout(constant_id = 3) const bool kFromZero = false;
PLANE_IN(0, system);
PLANE_IN(1, now);
PLANE_IN(2, finer_means);
PLANE_IN(3, source_term);  // of packs of cells: their pixels' mass
PLANE_OUT(4, target);
PLANE_OUT(5, coarse);
PLANE_OUT(6, means);
layout(push_constant) uniform Push {
  uvec2 size;          // of the fine level
  uvec2 finest;  // size of level 0
  float mass;          // of every fine pixel, if there is no plane of masses
  uint target_stride;  // of the right-hand side in `target`: vec4 per pack, and the index among them
  uint target_slot;
} push;

#define PAIRS(a, b) vec4((a).x + (a).y, (a).z + (a).w, (b).x + (b).y, (b).z + (b).w)

int packs = int(PACK4(push.size.x));

// The anchors' mass of pack x, rows y and y + 1, on levels 0 and 1; on level 1 of a row that represents one row of level 0.
vec4 anchors(int x, int y) {
  int cell_packs = int(PACK4((push.finest.x + 3u) / 4u));
  if (kMeans == 1) return vec4(FETCH(source_term, SOURCE_STRIDE * ((y / 4) * cell_packs + x / 4) + SOURCE_ANCHOR)[x & 3]);
  vec4 four = FETCH(source_term, SOURCE_STRIDE * ((y / 2) * cell_packs + x / 2) + SOURCE_ANCHOR);
  vec4 counts = vec4(clamp(ivec4(int(push.finest.x) - 8 * x) - ivec4(0, 2, 4, 6), 0, 2));
  return counts * ((x & 1) == 0 ? four.xxyy : four.zzww);
}
// Number of rows of level 0 that a row represents, if `anchors` does not include it.
float rows_of(int y) { return kMeans == 1 ? 1.0 : float(clamp(int(push.finest.y) - 2 * y, 0, 2)); }

void main() {
  uvec2 half_size = (push.size + 1u) / 2u;
  uint half_packs = PACK4(half_size.x);
  ivec2 position = ivec2(grid_position(half_packs));
  if (position.y >= int(half_size.y)) return;
  vec4 sum = vec4(0.0), mean = vec4(0.0);
  int top = 2 * position.y, count = min(int(push.size.y) - top, 2);
  for (int part = 0; part < 2; ++part) {
    int x = 2 * position.x + part;
    if (x >= packs) break;
    int at = top * packs + x, low = top + 1 < int(push.size.y) ? at + packs : at;
    vec4 total = vec4(0.0), s = vec4(0.0);
    if (kFromZero) {
      total = FETCH(system, kStride * at + SYSTEM_RHS);
      if (count > 1) total += FETCH(system, kStride * low + SYSTEM_RHS);
    } else {
      int above = top > 0 ? at - packs : at, left = x > 0 ? -1 : 0, right = x + 1 < packs ? 1 : 0;
      vec4 u = FETCH(now, at), under = FETCH(now, low);
      // Flow over the edge above a row, and over the edge below it.
      vec4 fall = (top > 0 ? 1.0 : 0.0) * FETCH(system, kStride * above + SYSTEM_DOWN) * (FETCH(now, above) - u);
      vec4 anchor = kStride > 3 ? vec4(0.0) : anchors(x, top);
      for (int row = 0; row < count; ++row) {
        vec4 w = FETCH(system, kStride * at + SYSTEM_RIGHT);
        vec4 flow = w * (SHIFT_LEFT(u, FETCH(now, at + right)) - u);
        float from_left = -float(left) * FETCH(system, kStride * (at + left) + SYSTEM_RIGHT).w *
                          (u.x - FETCH(now, at + left).w);
        vec4 next_fall = FETCH(system, kStride * at + SYSTEM_DOWN) * (u - under);
        total += FETCH(system, kStride * at + SYSTEM_RHS) + flow - SHIFT_RIGHT(flow, vec4(from_left)) + fall - next_fall -
                 (kStride > 3 ? FETCH(system, kStride * at + SYSTEM_MASS) : push.mass + rows_of(top + row) * anchor) * u;
        s += kMeans > 1 ? u + FETCH(finer_means, at) : u;
        fall = next_fall;
        at = low;
        u = under;
        under = FETCH(now, top + 2 < int(push.size.y) ? low + packs : low);
      }
    }
    sum += part == 0 ? vec4(total.xz + total.yw, 0.0, 0.0) : vec4(0.0, 0.0, total.xz + total.yw);
    mean += part == 0 ? vec4(s.xz + s.yw, 0.0, 0.0) : vec4(0.0, 0.0, s.xz + s.yw);
  }
  uint to = uint(position.y) * half_packs + uint(position.x);
  STORE(target, push.target_stride * to + push.target_slot, sum);
  STORE(coarse, to, vec4(0.0));
  if (kMeans > 0) {
    uvec4 columns = min(uvec4(push.size.x) - min(uvec4(push.size.x), 8u * uint(position.x) + uvec4(0, 2, 4, 6)), 2u);
    STORE(means, to, mean / max(vec4(columns * uint(count)), 1.0));
  }
}
