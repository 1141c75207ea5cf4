// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "matte.glsl"

// The light of the object and of what is behind it, near a border cell: means of core and of outside cells. w: 1, or 0 if there are
// none.
WORD_IN(0, classes);
PLANE_IN(1, light);
PLANE_OUT(2, object);
PLANE_OUT(3, behind);
layout(push_constant) uniform Push { ivec2 cells; } push;

void main() {
  ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
  if (cell.x >= push.cells.x) return;
  uint n = uint(cell.y * push.cells.x + cell.x);
  vec4 own = vec4(0.0), other = vec4(0.0);
  if ((FETCH1(classes, int(n)) & kBorder) != 0u) {
    ivec2 first = max(cell - kReach, ivec2(0)), last = min(cell + kReach, push.cells - 1);
    for (int y = first.y; y <= last.y; ++y)
      for (int x = first.x; x <= last.x; ++x) {
        int from = y * push.cells.x + x;
        uint side = FETCH1(classes, from) & (kCore | kOutside);
        if (side == kMixed) continue;
        vec2 off = vec2(x - cell.x, y - cell.y);
        vec4 seen = exp(-dot(off, off) / (2.0 * kSigma * kSigma)) * vec4(FETCH(light, from).rgb, 1.0);
        if (side == kCore)
          own += seen;
        else
          other += seen;
      }
  }
  STORE(object, n, own.w > 0.0 ? own / own.w : vec4(0.0));
  STORE(behind, n, other.w > 0.0 ? other / other.w : vec4(0.0));
}
