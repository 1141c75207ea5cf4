// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "intrinsic/guide/guide.glsl"

// EdgePrior, cells: v, V and g of energy.glsl from a cell's cues and, with kLearned, what a network adds. One pack of cells an
// invocation.
layout(constant_id = 1) const bool kLearned = false;
PLANE_IN(0, cells);
PLANE_IN(1, guide_coarse);
PLANE_IN(2, statistics);
PLANE_IN(3, tuning);
PLANE_IN(4, fields);  // network/fields.glsl
PLANE_OUT(5, value);
layout(push_constant) uniform Push {
  ivec2 size;  // of level 2
  float value_weight;
  float chroma_weight;
  ivec2 network_size;  // of the network's picture
  int network_level;
} push;
#include "edge_net.glsl"
#include "net.glsl"

const float kCellArea = 16.0;

// What the network adds: of the pixel that holds the cell, or the mean over those in it.
vec3 learned(ivec2 cell) {
  int shift = push.network_level - 2, count = 1 << max(-shift, 0);
  ivec2 first = shift >= 0 ? cell >> shift : cell << -shift, end = min(first + count, push.network_size);
  vec4 sum = vec4(0.0);
  for (int y = first.y; y < end.y; ++y)
    for (int x = first.x; x < end.x; ++x) sum += FETCH(fields, y * push.network_size.x + x);
  ivec2 pixels = end - first;
  return sum.xyz / float(pixels.x * pixels.y);
}

void main() {
  int packs = int(PACK4(uint(push.size.x)));
  ivec2 position = ivec2(grid_position(uint(packs)));
  if (position.y >= push.size.y) return;
  int wide_columns = ((push.size.x + 1) / 2 + 1) / 2;
  float mean = FETCH(statistics, STATISTICS_MEAN).x;
  vec4 v = vec4(0.0), target = vec4(0.0), g = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    int x = 4 * position.x + k, cell = CELL_STRIDE * (position.y * push.size.x + min(x, push.size.x - 1));
    vec4 p = FETCH(cells, cell), activity = FETCH(cells, cell + 1);
    vec4 around = p - FETCH(guide_coarse, (position.y >> 2) * wide_columns + position.x);
    float f[CELL_CUES];
    f[0] = 2.0 * p.w - 0.7;
    f[1] = clamp((p.x - mean) / 1.5, -2.0, 2.0);
    f[2] = clamp(0.5 * (p.x + 4.0), -1.0, 2.0);
    f[3] = cue(activity.x);
    f[4] = cue(activity.y);
    f[5] = clamp(around.x + around.w, -2.0, 2.0);
    f[6] = cue(length(around.yz));
    vec4 sums[CELL_VECTORS];
    CELL_BIASES(sums);
    vec3 result = cell_net(f, sums);
    if (kLearned) result += learned(ivec2(min(x, push.size.x - 1), position.y));
    float on = x < push.size.x ? 1.0 : 0.0;
    v = vec4(v.yzw, on * kCellArea * push.value_weight * weight(result.x));
    target = vec4(target.yzw, on * (p.x + p.w + result.y));
    g = vec4(g.yzw, on * kCellArea * push.chroma_weight * weight(result.z));
  }
  int to = VALUE_STRIDE * (position.y * packs + position.x);
  STORE(value, to + VALUE_WEIGHT, v);
  STORE(value, to + VALUE_TARGET, target);
  STORE(value, to + VALUE_CHROMA, g);
}
