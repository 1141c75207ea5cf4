// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit.glsl"

// The color of light after its base colors changed: L' = max(L + matte Σ_k t_k Δb_k, 0), t_k the share of S that bounced
// off base color k.
layout(constant_id = 1) const bool kMatte = false;
layout(constant_id = 2) const int kPlanes = 4;  // of shares, four base colors each
PLANE_IN(0, light);
PLANE_IN(1, share0);
PLANE_IN(2, share1);
PLANE_IN(3, share2);
PLANE_IN(4, share3);
PLANE_IN(5, change);  // bases.comp
PLANE_IN(6, mask);
PLANE_OUT(7, edited);
layout(push_constant) uniform Push {
  uvec2 size;
  uint first_row;
} push;

#define BOUNCED(k, share)                                                       \
  if (kPlanes > k) {                                                            \
    vec4 t = matte * finite(FETCH(share, n));                                   \
    l.rgb += t.x * FETCH(change, 4 * k).rgb + t.y * FETCH(change, 4 * k + 1).rgb + \
             t.z * FETCH(change, 4 * k + 2).rgb + t.w * FETCH(change, 4 * k + 3).rgb; \
  }

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec4 l = finite(FETCH(light, n));
    float matte = kMatte ? min(finite(FETCH(mask, n)).x, 1.0) : 1.0;
    BOUNCED(0, share0)
    BOUNCED(1, share1)
    BOUNCED(2, share2)
    BOUNCED(3, share3)
    STORE(edited, BY_ROWS(n), finite(l));
  }
}
