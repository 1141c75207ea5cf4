// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "relax.glsl"

// Half a block Gauss-Seidel pass, in place: the grid is a checkerboard of blocks of 4 x 4 pixels, and a pass over each
// color makes one step. An invocation updates one block with fixed surroundings: rows are solved exactly, downwards
// and back upwards. Invocations read and write disjoint blocks, so their order does not matter.
//
// With kCorrect, the first pass after a coarser level: adds the correction of that level's 2 x 2 aggregates to the block, and to
// its neighbors if push.around says that those are not corrected yet.
//
// On levels 0 and 1 the source term of a cell (source_term.comp) acts on its mean, so its pixels share it. A pixel is updated as if
// it were alone, which bounds the change: screening (mean s)^2 <= screening mean(s^2), with equality if all pixels agree. A cell's
// pixels have the mass of its anchor.
layout(constant_id = 1) const int kStride = 4;  // of the system: SYSTEM_FINE_STRIDE or SYSTEM_COARSE_STRIDE
layout(constant_id = 2) const bool kCorrect = false;
layout(constant_id = 3) const int kCellPixels = 0;  // pixels of this level along a cell, 4 or 2, or 0: no source_term
PLANE_IN(0, system);
PLANE_IN(1, now);
PLANE_IN(2, coarse);
PLANE_IN(3, source_term);      // of packs of cells
PLANE_OUT(4, improved);  // the same buffer as `now`
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 finest;  // size of level 0
  uint color;
  float mass;    // of every pixel, if there is no plane of masses
  float around;  // 1 or 0
} push;

ivec2 push_size = ivec2(push.size);
int packs = int(PACK4(push.size.x)), coarse_packs = int(PACK4((push.size.x + 1u) / 2u));

// The correction of pack x by the aggregates of row y.
vec4 lifted(int x, int y) {
  if (!kCorrect) return vec4(0.0);
  vec4 pairs = FETCH(coarse, (y >> 1) * coarse_packs + (x >> 1));
  return (x & 1) == 0 ? pairs.xxyy : pairs.zzww;
}

// How much the pixels of row y of pack x, which is row `row` of its cells, count in the cells' means.
vec4 shares(int x, int y, int row) {
  int rows = min(push_size.y - y + row, kCellPixels), columns = min(push_size.x - 4 * x, 4);
  if (kCellPixels == 4) return cell_weights(uint(rows))[row] * cell_weights(uint(columns));
  return (rows == 2 ? 0.5 : 1.0) * (columns == 4 ? vec4(0.5) : columns == 3 ? vec4(0.5, 0.5, 1.0, 0.0) :
                                    columns == 2 ? vec4(0.5, 0.5, 0.0, 0.0) : vec4(1.0, 0.0, 0.0, 0.0));
}
// Number of pixels of level 0 that those of row y of pack x represent.
vec4 counts(int x, int y) {
  if (kCellPixels == 4) return vec4(1.0);
  ivec2 size = ivec2(push.finest);
  return vec4(clamp(ivec4(size.x - 8 * x) - ivec4(0, 2, 4, 6), 0, 2) * clamp(size.y - 2 * y, 0, 2));
}
// A slot of the cells, at the pixels of row y of pack x.
vec4 of_cells(int x, int y, int slot) {
  int cell = 4 * x / kCellPixels, columns = (push_size.x + kCellPixels - 1) / kCellPixels;
  vec4 four = FETCH(source_term, SOURCE_STRIDE * ((y / kCellPixels) * int(PACK4(uint(columns))) + cell / 4) + slot);
  return kCellPixels == 4 ? vec4(four[cell & 3]) : (cell & 2) == 0 ? four.xxyy : four.zzww;
}

#define SOLVE_ROW(k, up, down) \
  u[k] = solve_pack(diagonal[k], right[k], rhs[k] + fall[k] * (up) + fall[k + 1] * (down))

void main() {
  ivec2 position = ivec2(grid_position(uint(packs + 1) / 2u)), last = ivec2(packs, push.size.y) - 1;
  int x = 2 * position.x + ((position.y + int(push.color)) & 1), first = 4 * position.y;
  if (x > last.x || first > last.y) return;
  int next = min(x + 1, last.x), before = max(x - 1, 0), top = max(first - 1, 0);
  float has_left = x > 0 ? 1.0 : 0.0;
  vec4 u[4], right[4], rhs[4], diagonal[4], fall[5];
  vec4 above = FETCH(now, top * packs + x) + push.around * lifted(x, top);
  int bottom = min(first + 4, last.y);
  vec4 below = FETCH(now, bottom * packs + x) + push.around * lifted(x, bottom);
  vec4 lift, lift_before, lift_next, data, screen_of_cell, anchor;  // of two rows, or of all if cells have four
  fall[0] = (first > 0 ? 1.0 : 0.0) * FETCH(system, kStride * (top * packs + x) + SYSTEM_DOWN);
  [[unroll]] for (int k = 0; k < 4; ++k) {
    int y = min(first + k, last.y), at = kStride * (y * packs + x);  // rows below the frame repeat the last, unused
    if (k % 2 == 0) {
      lift = lifted(x, y);
      lift_before = push.around * lifted(before, y);
      lift_next = push.around * lifted(next, y);
    }
    if (kCellPixels > 0 && (k == 0 || (k == 2 && kCellPixels == 2))) {
      data = of_cells(x, y, SOURCE_VALUE);
      screen_of_cell = of_cells(x, y, SOURCE_SCREENING);
      anchor = of_cells(x, y, SOURCE_ANCHOR);
    }
    u[k] = FETCH(now, y * packs + x) + lift;
    right[k] = FETCH(system, at + SYSTEM_RIGHT);
    fall[k + 1] = FETCH(system, at + SYSTEM_DOWN);
    rhs[k] = FETCH(system, at + SYSTEM_RHS);
    float left = has_left * FETCH(system, kStride * (y * packs + before) + SYSTEM_RIGHT).w;
    diagonal[k] = (kStride > 3 ? FETCH(system, at + SYSTEM_MASS) : vec4(push.mass)) + right[k] +
                  SHIFT_RIGHT(right[k], vec4(left)) + fall[k] + fall[k + 1];
    if (kCellPixels > 0) {
      vec4 share = shares(x, first + k, kCellPixels == 4 ? k : k % 2), screen = share * screen_of_cell;
      diagonal[k] += screen + counts(x, y) * anchor;
      rhs[k] += share * data + screen * u[k];
    }
    rhs[k].x += left * (FETCH(now, y * packs + before).w + lift_before.w);
    rhs[k].w += right[k].w * (FETCH(now, y * packs + next).x + lift_next.x);
  }
  SOLVE_ROW(0, above, u[1]);
  SOLVE_ROW(1, u[0], u[2]);
  SOLVE_ROW(2, u[1], u[3]);
  SOLVE_ROW(3, u[2], below);
  SOLVE_ROW(2, u[1], u[3]);
  SOLVE_ROW(1, u[0], u[2]);
  SOLVE_ROW(0, above, u[1]);
  [[unroll]] for (int k = 0; k < 4; ++k)
    if (first + k <= last.y) STORE(improved, uint((first + k) * packs + x), u[k]);
}
