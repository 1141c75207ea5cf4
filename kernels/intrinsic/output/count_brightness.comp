// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "intrinsic/guide/guide.glsl"
#include "intrinsic/output/brightness.glsl"

// Counts ln max_c R and ln S over the cells of a frame (brightness.glsl), and writes each cell for ScaleNormalization (scale.glsl). One cell of 4 x 4
// pixels an invocation.
PLANE_IN(0, cells);
PLANE_IN(1, shading);
WORD_INOUT(2, counts);
PLANE_OUT(3, scale_cells);
PLANE_IN(4, light);  // .y: m at which the guide takes light as white
layout(push_constant) uniform Push { uvec2 size; } push;

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 cell = grid_position(packs);
  uint first = 4u * cell.y;
  if (first >= push.size.y) return;
  uvec2 count = min(push.size - 4u * cell, uvec2(4u));
  vec4 columns = cell_weights(count.x), rows = cell_weights(count.y);
  float mean = 0.0;
  for (uint y = 0u; y < count.y; ++y) {
    mean += rows.x * dot(columns, FETCH(shading, int((first + y) * packs + cell.x)));
    rows = rows.yzwx;
  }
  uint at = cell.y * packs + cell.x;
  vec4 guide = FETCH(cells, int(CELL_STRIDE * at));
  // The mean channel is what is visible; a tint that a caller divides the frame by moves m farther.
  STORE(scale_cells, at, vec4(guide.xyz, guide.x + mean_channel(guide.yz) - mean));
  float brightest = guide.x + guide.w;
  if (brightest <= kDarkest) return;
  atomicAdd(counts_data[brightness_bin(brightest - mean)], 1u);
  uint weight = white_weight(guide.x - FETCH(light, 0).y);
  if (weight > 0u) atomicAdd(counts_data[kBrightnessBins + brightness_bin(mean)], weight);
}
