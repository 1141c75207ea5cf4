// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"

// Slopes of a relief in which each octave of log shading is as deep as it is wide: sum over levels l of D u_l, D the
// difference between neighbors of that level. One level, added to the coarser ones.
layout(constant_id = 1) const bool COARSEST = false;  // there is none that is coarser
SCALAR_IN(0, heights);  // u of this level
PLANE_IN(1, coarser);   // slopes of the next
PLANE_OUT(2, slopes);   // x, y, -, -
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 coarse_size;
  uint finest;  // 1: bound the sum
} push;

const float kMaxSlope = 1.0;  // slopes come near to it

float height_at(ivec2 at) {
  ivec2 inside = clamp(at, ivec2(0), ivec2(push.size) - 1);
  return FETCH1(heights, inside.y * int(push.size.x) + inside.x);
}

vec2 coarser_at(ivec2 at) {
  vec2 place = clamp((vec2(at) - 0.5) * 0.5, vec2(0.0), vec2(push.coarse_size - 1u));
  ivec2 low = ivec2(place), high = min(low + 1, ivec2(push.coarse_size) - 1);
  vec2 part = place - vec2(low);
  int above = low.y * int(push.coarse_size.x), below = high.y * int(push.coarse_size.x);
  return mix(mix(FETCH(coarser, above + low.x).xy, FETCH(coarser, above + high.x).xy, part.x),
             mix(FETCH(coarser, below + low.x).xy, FETCH(coarser, below + high.x).xy, part.x), part.y);
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= int(push.size.x) || at.y >= int(push.size.y)) return;
  vec2 slope = 0.5 * vec2(height_at(at + ivec2(1, 0)) - height_at(at - ivec2(1, 0)),
                          height_at(at + ivec2(0, 1)) - height_at(at - ivec2(0, 1)));
  if (!COARSEST) slope += coarser_at(at);
  if (push.finest == 1u) slope *= inversesqrt(1.0 + dot(slope, slope) / (kMaxSlope * kMaxSlope));
  STORE(slopes, at.y * int(push.size.x) + at.x, vec4(slope, 0.0, 0.0));
}
