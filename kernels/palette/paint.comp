// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"
#include "palette/max_clusters.glsl"

// Paints every pixel in the color of the cluster nearest to it in ln R; black if there is none.
PLANE_IN(0, model);
PLANE_IN(1, palette);  // Palette::colors()
PLANE_OUT(2, painted);
layout(push_constant) uniform Push {
  uvec2 size;
  int clusters;
  uint first_row;
} push;

void main() {
  uvec2 at = gl_GlobalInvocationID.xy + uvec2(0u, push.first_row);
  if (at.x >= push.size.x) return;
  uint n = at.y * push.size.x + at.x;
  vec3 r = log(max(finite(FETCH(model, int(n))).rgb, vec3(kReflectanceFloor)));
  vec3 color = vec3(-1e4);
  float nearest = 3.4e38;
  for (int k = 0; k < push.clusters; ++k) {
    vec4 cluster = FETCH(palette, kMaxClusters + k);
    vec3 off = r - cluster.rgb;
    float squared = cluster.w > 0.0 ? dot(off, off) : 3.4e38;
    color = squared < nearest ? cluster.rgb : color;
    nearest = min(nearest, squared);
  }
  STORE(painted, BY_ROWS(n), vec4(exp(color), 1.0));
}
