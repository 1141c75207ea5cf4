// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "relax.glsl"

// The next coarser level's operator, once a frame: aggregates of 2 x 2 pixels add their masses up, and the edges between
// two aggregates make theirs (relax.glsl). With kTerms that level is the cells' and gets their screen and their
// pixels' anchors too.
// One coarse pack an invocation.
layout(constant_id = 1) const int kStride = 4;        // of the fine system
layout(constant_id = 2) const int kCoarseStride = 4;
layout(constant_id = 3) const bool kTerms = false;
PLANE_IN(0, system);
PLANE_IN(1, source_term);  // of packs of cells
PLANE_OUT(2, coarse_system);
layout(push_constant) uniform Push {
  uvec2 size;  // of the fine level
  uvec2 finest;  // size of level 0
  float scale;
  float mass;  // of every fine pixel, if there is no plane of masses
} push;

#define PAIRS(a, b) vec4((a).x + (a).y, (a).z + (a).w, (b).x + (b).y, (b).z + (b).w)

void main() {
  uvec2 half_size = (push.size + 1u) / 2u;
  int packs = int(PACK4(push.size.x));
  uint half_packs = PACK4(half_size.x);
  uvec2 position = grid_position(half_packs);
  if (position.y >= half_size.y) return;
  int x = 2 * int(position.x), second = x + 1 < packs ? 1 : 0, third = x + 2 < packs ? 2 : 0;
  vec4 across = vec4(0.0), inside = vec4(0.0), next = vec4(0.0), along[3], mass = vec4(0.0);  // along: of three rows
  for (uint k = 0u; k < 3u; ++k) {
    uint y = 2u * position.y + k;
    float has = y < push.size.y ? 1.0 : 0.0;
    int row = kStride * (int(min(y, push.size.y - 1u)) * packs + x);
    vec4 da = FETCH(system, row + SYSTEM_DOWN), db = float(second) * FETCH(system, row + kStride * second + SYSTEM_DOWN);
    along[k] = has * PAIRS(da, db);
    if (k == 2u) break;
    vec4 ra = has * FETCH(system, row + SYSTEM_RIGHT);
    vec4 rb = has * float(second) * FETCH(system, row + kStride * second + SYSTEM_RIGHT);
    across += vec4(ra.yw, rb.yw);
    inside += vec4(ra.xz, rb.xz);
    next += has * (third > 0 ? 1.0 : 0.0) * FETCH(system, row + kStride * third + SYSTEM_RIGHT).x;
    if (kCoarseStride > 3) {
      vec4 ma = vec4(push.mass), mb = vec4(push.mass);
      if (kStride > 3) {
        ma = FETCH(system, row + SYSTEM_MASS);
        mb = float(second) * FETCH(system, row + kStride * second + SYSTEM_MASS);
      }
      mass += has * PAIRS(ma, mb);
    }
  }
  bvec4 last = equal(uvec4(8u * position.x) + uvec4(3, 5, 7, 9), uvec4(push.size.x));
  vec4 right = in_series(across, inside, SHIFT_LEFT(inside, next), last, push.scale);
  vec4 down = in_series(along[1], along[0], along[2], bvec4(2u * position.y + 3u == push.size.y), push.scale);
  uint to = position.y * half_packs + position.x;
  STORE(coarse_system, uint(kCoarseStride) * to + SYSTEM_RIGHT, right);
  STORE(coarse_system, uint(kCoarseStride) * to + SYSTEM_DOWN, down);
  if (kCoarseStride > 3) {
    if (kTerms) {
      ivec2 size = ivec2(push.finest);
      ivec4 pixels = clamp(ivec4(size.x - 16 * int(position.x)) - ivec4(0, 4, 8, 12), 0, 4) *
                     clamp(size.y - 4 * int(position.y), 0, 4);
      mass += FETCH(source_term, SOURCE_STRIDE * int(to) + SOURCE_SCREENING) + vec4(pixels) * FETCH(source_term, SOURCE_STRIDE * int(to) + SOURCE_ANCHOR);
    }
    STORE(coarse_system, uint(kCoarseStride) * to + SYSTEM_MASS, MASKED(mass, INSIDE(position.x, half_size.x)));
  }
}
