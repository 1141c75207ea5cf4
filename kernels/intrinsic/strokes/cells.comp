// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "image/strokes/strokes.glsl"

// The mask of cells of 4 x 4 pixels: the stroke that covers most of a cell, and its share of it. One pack of cells an invocation.
PLANE_IN(0, mask);
PLANE_OUT(1, cell_mask);
layout(push_constant) uniform Push { uvec2 size; } push;  // of the frame

void main() {
  uvec2 cells = (push.size + 3u) / 4u;
  uint packs = PACK4(push.size.x), cell_packs = PACK4(cells.x);
  uvec2 position = grid_position(cell_packs);
  if (position.y >= cells.y) return;
  vec4 result = vec4(0.0);
  for (uint k = 0u; k < 4u; ++k) {
    uint cell = 4u * position.x + k;
    result = result.yzwx;
    if (cell >= cells.x) continue;
    uvec2 count = min(push.size - 4u * uvec2(cell, position.y), uvec2(4u));
    vec4 columns = cell_weights(count.x), rows = cell_weights(count.y), pack[4];
    for (uint y = 0u; y < 4u; ++y)
      pack[y] = y < count.y ? FETCH(mask, int((4u * position.y + y) * packs + cell)) : vec4(0.0);
    float best = 0.0, best_share = 0.0;
    for (uint i = 0u; i < 16u; ++i) {
      float number = floor(pack[i >> 2][i & 3u]), share = 0.0;
      if (number == 0.0 || number == best) continue;
      for (uint y = 0u; y < 4u; ++y)
        share += rows[y] * dot(columns, mix(vec4(0.0), weight_of(pack[y]), equal(number_of(pack[y]), vec4(number))));
      if (share > best_share || (share == best_share && number < best)) {
        best = number;
        best_share = share;
      }
    }
    result.w = best_share > 0.0 ? best + 0.5 * best_share : 0.0;
  }
  STORE(cell_mask, position.y * cell_packs + position.x, result);
}
