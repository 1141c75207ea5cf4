// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "palette.glsl"
#include "gpu/workgroup_sum.glsl"

// One workgroup: weighted k-means over the list of bins, from the clusters that there are.
PLANE_IN(0, list);
WORD_IN(1, list_length);
PLANE_INOUT(2, clusters);  // (color, pixels)
WORD_INOUT(3, labels);     // per bin

shared vec4 centers[kMaxClusters];

uint nearest_center(vec3 color) {
  uint best = 0u;
  float nearest = 3.4e38;
  for (int k = 0; k < push.clusters; ++k) {
    vec3 d = color - centers[k].rgb;
    float distance2 = centers[k].w > 0.0 ? dot(d, d) : 3.4e38;
    best = distance2 < nearest ? uint(k) : best;
    nearest = min(nearest, distance2);
  }
  return best;
}

void main() {
  int lane = int(gl_LocalInvocationID.x);
  int stride = int(gl_WorkGroupSize.x);
  int length = int(FETCH1(list_length, 0));
  if (lane < push.clusters) centers[lane] = LOAD(clusters, lane);
  barrier();
  for (int iteration = 0; iteration < push.iterations; ++iteration) {
    for (int n = lane; n < length; n += stride) STORE(labels, n, nearest_center(FETCH(list, n).rgb));
    for (int k = 0; k < push.clusters; ++k) {
      vec4 sum = vec4(0.0);
      for (int n = lane; n < length; n += stride) {
        vec4 bin = FETCH(list, n);
        sum += (LOAD(labels, n) == uint(k) ? bin.w : 0.0) * vec4(bin.rgb, 1.0);
      }
      sum = workgroup_sum(sum);
      // The nearest_center calls of this iteration are behind the barriers of workgroup_sum.
      if (lane == 0) centers[k] = vec4(sum.w > 0.0 ? sum.rgb / sum.w : centers[k].rgb, sum.w);
    }
    barrier();
  }
  if (lane < push.clusters) STORE(clusters, lane, centers[lane]);
}
