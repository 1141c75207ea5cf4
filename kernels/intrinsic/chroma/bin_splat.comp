// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "bins.glsl"

// Adds every cell to the four bins around its chroma: with kWeights its weight g, else g (r / kMaxReflectance + 1) / 2 of the current
// solution, r = m' - s' - (correction of s'), so that all sums grow. Invocations go over all packs of cells.
// A workgroup shares bins by atomics and adds them to those of all at the end: most cells fall into few bins, for which all
// invocations of a GPU would queue. If kTables > 1, kTables invocations have bins of their own, because atomic additions dominate the
// time on a CPU. Sums in fixed point are equal either way.
layout(constant_id = 1) const bool kWeights = false;
layout(constant_id = 2) const uint kTables = 1;
PLANE_IN(0, cells);
PLANE_IN(1, terms);
PLANE_IN(2, mean);        // s'
PLANE_IN(3, correction);
WORD_INOUT(4, sums);      // kTables tables, interleaved; start at 0 (bin_means.comp)
layout(push_constant) uniform Push {
  uvec2 size;  // of level 2
  float scale;
} push;

const uint kAll = uint(kBins * kBins);
shared uint low_words[kTables > 1u ? 1u : kAll];  // of the workgroup's sums; carries go to `sums` at once

// Adds to a word of `sums` and returns what it was.
uint add_word(uint at, uint more) {
  if (kTables == 1u) return atomicAdd(LOAD(sums, at), more);
  uint before = LOAD(sums, at);
  STORE(sums, at, before + more);
  return before;
}

void add(uint bin, uint share) {
  uint low = bin * kTables + (kTables > 1u ? line_index() : 0u);
  uint before = kTables > 1u ? add_word(low, share) : atomicAdd(low_words[bin], share);
  // Carries are rare. On a CPU a loop that no invocation enters costs nothing, unlike a branch.
  for (bool carry = before + share < before; carry; carry = false) add_word(low + kAll * kTables, 1u);
}

void main() {
  uint packs = PACK4(push.size.x), all = packs * push.size.y;
  if (kTables == 1u) {
    for (uint bin = gl_LocalInvocationIndex; bin < kAll; bin += gl_WorkGroupSize.x) low_words[bin] = 0u;
    barrier();
  }
  uint step = kTables > 1u ? kTables : gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_WorkGroupSize.x;
  for (uint i = line_index(); i < all; i += step) {
    uvec2 position = grid_place(i, packs);
    int at = int(i);
    vec4 part = push.scale * FETCH(terms, TERMS_STRIDE * at + TERMS_CHROMA);
    if (!kWeights) {
      vec4 r = FETCH(terms, TERMS_STRIDE * at + TERMS_MEAN) - FETCH(mean, at) - FETCH(correction, at);
      part *= 0.5 * clamp(r / kMaxReflectance, -1.0, 1.0) + 0.5;
    }
    uint count = min(push.size.x - 4u * position.x, 4u);
    for (uint k = 0u; k < count; ++k) {
      vec2 fraction, chroma = FETCH(cells, int(CELL_STRIDE * (position.y * push.size.x + 4u * position.x + k))).yz;
      uvec2 bin = bin_of(chroma, fraction);
      uvec4 shares = uvec4(round(hats(fraction) * part.x));
      uint to = bin.y * uint(kBins) + bin.x;
      add(to, shares.x);
      add(to + 1u, shares.y);
      add(to + uint(kBins), shares.z);
      add(to + uint(kBins) + 1u, shares.w);
      part = part.yzwx;
    }
  }
  if (kTables > 1u) return;
  barrier();
  for (uint bin = gl_LocalInvocationIndex; bin < kAll; bin += gl_WorkGroupSize.x) {
    uint share = low_words[bin];
    if (share == 0u) continue;
    uint before = add_word(bin, share);
    if (before + share < before) add_word(bin + kAll, 1u);
  }
}
