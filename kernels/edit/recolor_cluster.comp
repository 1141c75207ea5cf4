// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "recolor.glsl"

// Recolors pixels that are nearer to one cluster's color than to any other's, in ln R of the unedited reflectance: selection goes
// from 0 to 1 as (distance to the nearest other − distance to this one) goes from −softness / 2 to softness / 2.
PLANE_IN(4, model);
PLANE_IN(5, palette);  // Palette::colors()

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  // The cluster it was merged into; −1: it has no pixels, or was not searched for.
  int chosen = push.cluster < push.clusters ? int(FETCH(palette, push.cluster).w) : -1;
  vec4 color = FETCH(palette, kMaxClusters + max(chosen, 0));
  float key_value = mean3(exp(color.rgb)) + kValueFloor;

  vec3 r[kRows];
  vec4 own = vec4(0.0), other = vec4(1e30);
  for (uint i = 0u; i < kRows; ++i) {
    uint y = min(at.y + i, push.size.y - 1u);
    r[i] = log(max(finite(FETCH(model, int(y * push.size.x + at.x))).rgb, vec3(kReflectanceFloor)));
    vec3 off = r[i] - color.rgb;
    own[i] = dot(off, off);
  }
  for (int k = 0; k < push.clusters; ++k) {
    vec4 center = FETCH(palette, kMaxClusters + k);
    bool counts = center.w > 0.0 && k != chosen;
    for (uint i = 0u; i < kRows; ++i) {
      vec3 off = r[i] - center.rgb;
      other[i] = counts ? min(other[i], dot(off, off)) : other[i];
    }
  }
  vec4 margin = sqrt(other) - sqrt(own);
  for (uint i = 0u; i < kRows; ++i) {
    if (at.y + i >= push.size.y) break;
    float selection = chosen < 0 ? 0.0 : falling(0.5 - margin[i] * push.fall_off);
    uint n = (at.y + i) * push.size.x + at.x;
    recolor(n, finite(FETCH(intrinsic, int(n))), selection, key_value);
  }
}
