// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "intrinsic/guide/guide.glsl"
#include "light.glsl"

// The points of a frame (light.glsl): the mean of up to 4 x 4 pixels spread over a cell. One cell an invocation.
PLANE_IN(0, frame);
PLANE_OUT(1, points);
layout(push_constant) uniform Push {
  uvec2 size;   // of the frame
  uvec2 cells;
  uint factor;  // pixels along a cell
} push;

const uint kSamples = 4u;   // along a cell
const float kDark = 0.02;   // at which the weight is a half

void main() {
  uint i = line_index();
  uvec2 cell = uvec2(i % push.cells.x, i / push.cells.x);
  if (cell.y >= push.cells.y) return;
  uvec2 first = push.factor * cell, count = min(push.size - first, uvec2(push.factor)), samples = min(count, uvec2(kSamples));
  vec3 mean = vec3(0.0);
  for (uint y = 0u; y < samples.y; ++y)
    for (uint x = 0u; x < samples.x; ++x) {
      uvec2 at = first + (2u * uvec2(x, y) + 1u) * count / (2u * samples);
      mean += min(sanitize(FETCH(frame, int(at.y * push.size.x + at.x)).rgb), vec3(1.0));
    }
  mean /= float(samples.x * samples.y);
  vec3 color = log(mean + kChromaFloor);
  float m = mean_log(mean), light = exp(m);
  STORE(points, i, vec4(m, color.r - color.b, 0.5 * (color.r + color.b) - color.g, light / (light + kDark)));
}
