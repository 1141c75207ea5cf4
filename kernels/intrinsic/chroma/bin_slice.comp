// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/energy/energy.glsl"
#include "intrinsic/guide/guide.glsl"
#include "bins.glsl"

// Right-hand side of the cells for a correction of s': f = far + target - screening s', target = data + g (m' - r_bin), where `far`
// is the residual of the finer levels. Without kHasBins g is 0 and target = data. One pack of cells an invocation.
layout(constant_id = 1) const bool kHasBins = true;
PLANE_IN(0, cells);
PLANE_IN(1, terms);
PLANE_IN(2, mean);  // s'
PLANE_IN(3, far);
SCALAR_IN(4, means);
PLANE_OUT(5, system);  // of stride 4
PLANE_OUT(6, target);
layout(push_constant) uniform Push { uvec2 size; } push;  // of level 2

void main() {
  uint packs = PACK4(push.size.x);
  uvec2 position = grid_position(packs);
  if (position.y >= push.size.y) return;
  int at = int(position.y * packs + position.x);
  vec4 s = FETCH(mean, at), found = s, m = FETCH(terms, TERMS_STRIDE * at + TERMS_MEAN);
  for (uint k = 0u; kHasBins && k < 4u; ++k) {
    uint cell = position.y * push.size.x + min(4u * position.x + k, push.size.x - 1u);
    vec2 fraction;
    uvec2 bin = bin_of(FETCH(cells, int(CELL_STRIDE * cell)).yz, fraction);
    int from = int(bin.y) * kBins + int(bin.x);
    vec4 four = vec4(FETCH1(means, from), FETCH1(means, from + 1), FETCH1(means, from + kBins), FETCH1(means, from + kBins + 1));
    bvec4 known = lessThan(four, vec4(kEmptyBin));
    vec4 hat = mix(vec4(0.0), hats(fraction), known);
    float sum = dot(hat, vec4(1.0)), r = dot(hat, mix(vec4(0.0), four, known)) / max(sum, 1e-20);
    found = vec4(found.yzw, sum > 0.0 ? m.x - r : found.x);
    m = m.yzwx;
  }
  vec4 value = FETCH(terms, TERMS_STRIDE * at + TERMS_DATA);
  if (kHasBins) value += FETCH(terms, TERMS_STRIDE * at + TERMS_CHROMA) * found;
  STORE(target, uint(at), value);
  STORE(system, SYSTEM_COARSE_STRIDE * uint(at) + SYSTEM_RHS, FETCH(far, at) + value - FETCH(terms, TERMS_STRIDE * at + TERMS_SCREENING) * s);
}
