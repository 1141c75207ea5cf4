// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "palette.glsl"

// The cluster nearest to r in ln R: (ln color, index); index −1 if there is no cluster.
PLANE_IN(0, reflectance);
PLANE_IN(1, palette);
PLANE_OUT(2, nearest_clusters);

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= push.size.x) return;
  int n = int(at.y * push.size.x + at.x);
  vec3 r = FETCH(reflectance, n).rgb;
  vec4 best = vec4(0.0, 0.0, 0.0, -1.0);
  float nearest = 3.4e38;
  for (int k = 0; k < push.clusters; ++k) {
    vec4 cluster = FETCH(palette, kMaxClusters + k);
    vec3 d = r - cluster.rgb;
    float distance2 = cluster.w > 0.0 ? dot(d, d) : 3.4e38;
    best = distance2 < nearest ? vec4(cluster.rgb, float(k)) : best;
    nearest = min(nearest, distance2);
  }
  STORE(nearest_clusters, n, best);
}
