// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "thesis/chapter5/energy/energy.glsl"
#define TABLE_SLOT 0
#include "thesis/chapter5/energy/table.glsl"

// Targets (r_cluster, λ_clustering; 0 without a cluster).
PLANE_IN(1, features);
PLANE_IN(2, regions);
PLANE_OUT(3, targets);

// Modes: by clusters, which marked regions overrule if their x is the slot of one.
const int kClusters = 0, kRegions = 1;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= push.size.x) return;
  int n = at.y * push.size.x + at.x;
  int cluster = int(FETCH(features, n).w);
  int demanded = push.mode == kRegions ? int(FETCH(regions, n).x) : -1;
  demanded = demanded < push.centers ? demanded : -1;
  bool overruled = demanded >= 0 && center(max(demanded, 0)).w > 0.0;
  cluster = overruled ? demanded : cluster;
  STORE(targets, n, cluster < 0 ? vec4(0.0) : vec4(center_target(cluster).rgb, push.lambda_clustering));
}
