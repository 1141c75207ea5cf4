// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/random.glsl"
#include "palette.glsl"

// One workgroup: k-means++ for clusters without pixels: all of them at the start, later those that lost theirs. A cluster is
// drawn among the bins with probability proportional to pixels × squared distance to the nearest cluster, which must be
// at least a bin's width away, and after the start `apart` in chromaticity: a duplicate could replace the color, and change its
// index.
PLANE_IN(0, list);
WORD_IN(1, list_length);
PLANE_INOUT(2, clusters);  // (color, pixels)

shared vec4 centers[kMaxClusters];
shared float sums[256];
shared int chosen_lane;
shared float chosen_mass;

vec3 chroma(vec3 v) { return (v + push.chroma_floor) / ((v.r + v.g + v.b) * (1.0 / 3.0) + push.chroma_floor); }

float mass(vec4 bin) {
  float nearest = 3.4e38;
  if (push.first == 0 && push.apart > 0.0) {
    vec3 own = chroma(bin.rgb);
    bool near = false;
    for (int k = 0; k < push.clusters; ++k) {
      vec3 d = own - chroma(centers[k].rgb);
      near = near || (centers[k].w > 0.0 && dot(d, d) < push.apart * push.apart);
    }
    if (near) return 0.0;
  }
  for (int k = 0; k < push.clusters; ++k) {
    vec3 d = bin.rgb - centers[k].rgb;
    nearest = centers[k].w > 0.0 ? min(nearest, dot(d, d)) : nearest;
  }
  return bin.w * (nearest < 3e38 ? (nearest * float(kBins * kBins) < 1.0 ? 0.0 : nearest) : 1.0);
}

void main() {
  int lane = int(gl_LocalInvocationID.x);
  int length = int(FETCH1(list_length, 0));
  int share = (length - 1) / int(gl_WorkGroupSize.x) + 1;
  int first = min(lane * share, length);
  int last = min(first + share, length);
  if (lane < push.clusters) centers[lane] = push.first == 1 ? vec4(0.0) : LOAD(clusters, lane);
  barrier();
  for (int k = 0; k < push.clusters; ++k) {
    bool missing = centers[k].w <= 0.0;
    float sum = 0.0;
    for (int n = first; n < last && missing; ++n) sum += mass(FETCH(list, n));
    sums[lane] = sum;
    barrier();
    if (lane == 0) {
      float total = 0.0;
      for (int i = 0; i < int(gl_WorkGroupSize.x); ++i) total += sums[i];
      float target = total * float(pcg3d(uvec3(uint(k), push.frame, push.seed)).x >> 8u) * (1.0 / 16777216.0);
      float below = 0.0;
      int at = 0;
      while (at + 1 < int(gl_WorkGroupSize.x) && below + sums[at] <= target) below += sums[at++];
      chosen_lane = total > 0.0 ? at : -1;
      chosen_mass = target - below;
    }
    barrier();
    if (missing && lane == chosen_lane) {
      float below = 0.0;
      vec4 choice = vec4(0.0);
      for (int n = first; n < last && below <= chosen_mass; ++n) {
        vec4 bin = FETCH(list, n);
        float m = mass(bin);
        below += m;
        choice = m > 0.0 ? vec4(bin.rgb, 1.0) : choice;
      }
      centers[k] = choice;
    }
    barrier();
  }
  if (lane < push.clusters) STORE(clusters, lane, centers[lane]);
}
