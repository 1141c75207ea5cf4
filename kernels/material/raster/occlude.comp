// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "ground.glsl"

// Share of a uniform sky's light that an object blocks from each point of the ground (insertion.hpp).
PLANE_IN(0, heights);  // depth from below in pixels, coverage
PLANE_OUT(1, occlusion);
layout(push_constant) uniform Push {
  float ground;  // its height, in radii of the object
  float soft;    // added to heights
} push;

const float kPi = 3.14159265358979;

void main() {
  int i = int(line_index());
  if (i >= kOcclusion * kOcclusion) return;
  vec2 at = (vec2(i % kOcclusion, i / kOcclusion) + 0.5) / kPerUnit - kReach;
  float area = 1.0 / (kPerUnit * kPerUnit), hidden = 0.0;
  for (int k = 0; k < kHeights * kHeights; ++k) {
    vec2 underside = FETCH(heights, k).xy;
    vec2 away = (vec2(k % kHeights, k / kHeights) + 0.5) / kPerUnit - 1.0 - at;
    float height = max(-underside.x / kPerUnit - push.ground, 0.0) + push.soft;
    // A patch just above the ground hides at most the whole sky: use a disc of its area.
    float h2 = height * height + area / kPi, d2 = dot(away, away) + h2;
    hidden += underside.y * h2 * area / (kPi * d2 * d2);
  }
  float edge = clamp(2.0 * (kReach - length(at)), 0.0, 1.0);  // nothing ends in a line
  STORE(occlusion, i, vec4(min(hidden, 1.0) * edge * edge * (3.0 - 2.0 * edge), 0.0, 0.0, 0.0));
}
