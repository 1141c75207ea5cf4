// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "image/strokes/strokes.glsl"

// Cells of which the share c lies in a stroke: their target is moved by c to the stroke's mean (means.comp), their chroma weight
// becomes (1 - c) g. To be run once on cells as the prior has written them. One pack of cells an invocation.
PLANE_IN(0, cell_mask);
PLANE_IN(1, strokes);
PLANE_IN(2, means);
PLANE_IN(3, cells);
PLANE_INOUT(4, value);
layout(push_constant) uniform Push { uvec2 size; } push;  // of the cells

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  if (position.y >= push.size.y) return;
  int at = int(position.y * packs + position.x);
  vec4 mask = FETCH(cell_mask, at);
  if (all(equal(mask, vec4(0.0)))) return;
  vec4 share = weight_of(mask), target = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    int stroke = int(mask[k]) - 1;
    if (stroke < 0) continue;
    target[k] = FETCH(means, stroke).x;
    if (FETCH(strokes, STROKE_STRIDE * stroke + STROKE_KIND).x == float(KIND_REFLECTANCE))
      target[k] += FETCH(cells, CELL_STRIDE * int(position.y * push.size.x + 4u * position.x) + CELL_STRIDE * k).x;
  }
  uint to = VALUE_STRIDE * uint(at);
  STORE(value, to + VALUE_TARGET, mix(LOAD(value, to + VALUE_TARGET), target, share));
  STORE(value, to + VALUE_CHROMA, (1.0 - share) * LOAD(value, to + VALUE_CHROMA));
}
