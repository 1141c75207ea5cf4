// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"
#include "image/light_color.glsl"

// Draws the light of a frame with indirect light: S times its color, the direct part, the indirect part, or the part
// that bounced off one base color. With kSlope, S has a color of its own; kPlain: it is all that there is.
layout(constant_id = 1) const uint kWhat = 0u;  // LightPicture::What
layout(constant_id = 2) const bool kLamp = false;  // direct light has a color
layout(constant_id = 3) const bool kSlope = false;
layout(constant_id = 4) const bool kPlain = false;
const uint kAll = 0u, kDirect = 1u, kIndirect = 2u, kLayer = 3u;
PLANE_IN(0, intrinsic);
PLANE_IN(1, light);
PLANE_IN(2, share);  // kLayer: the plane of indirect shares
PLANE_IN(3, bases);
PLANE_IN(4, lamp);  // one pixel; kLamp
PLANE_IN(5, slope);  // one pixel; kSlope
PLANE_OUT(6, picture);
layout(push_constant) uniform Push {
  uvec2 size;
  uint base;  // kLayer: which base color
  uint first_row;
} push;
const uint kRows = 4u;  // pixels an invocation, one above the other

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  vec4 base = vec4(0.0), slot = vec4(0.0);
  vec3 white = kLamp ? finite(FETCH(lamp, 0)).rgb : vec3(1.0);
  if (kWhat == kLayer) {
    base = finite(FETCH(bases, int(push.base)));
    if (base.w == 0.0) base = vec4(0.0);
    slot[push.base & 3u] = 1.0;
  }
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec3 shading = finite(FETCH(intrinsic, n)).www;
    if (kSlope) shading = colored_light(FETCH(slope, 0), shading.x);
    vec4 l = kPlain ? vec4(1.0) : finite(FETCH(light, n));
    vec3 color = kWhat == kDirect     ? l.w * white
                 : kWhat == kIndirect ? max(l.rgb - l.w * white, vec3(0.0))
                 : kWhat == kLayer    ? base.rgb * dot(slot, finite(FETCH(share, n)))
                                      : l.rgb;
    STORE(picture, BY_ROWS(n), vec4(min(shading * color, vec3(kLargest)), 1.0));
  }
}
