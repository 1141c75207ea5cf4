#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "edit.glsl"

// The color of light after its base colors changed: L' = max(L + matte Σ_k t_k Δb_k, 0), t_k the share of S that bounced
// off base color k. Four of them at a time.
layout(constant_id = 1) const bool kMatte = false;
PLANE_IN(0, light);
PLANE_IN(1, share);
PLANE_IN(2, change);  // bases.comp
PLANE_IN(3, mask);
PLANE_OUT(4, edited);
layout(push_constant) uniform Push {
  uvec2 size;
  int first;  // base color of the plane of shares
} push;

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  vec3 delta[4];
  for (int k = 0; k < 4; ++k) delta[k] = FETCH(change, push.first + k).rgb;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec4 l = finite(FETCH(light, n)), t = finite(FETCH(share, n));
    if (kMatte) t *= min(finite(FETCH(mask, n)).x, 1.0);
    vec3 color = l.rgb + t.x * delta[0] + t.y * delta[1] + t.z * delta[2] + t.w * delta[3];
    STORE(edited, n, vec4(clamp(color, vec3(0.0), vec3(kLargest)), l.w));
  }
}
