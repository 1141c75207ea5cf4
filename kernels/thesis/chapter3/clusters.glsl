// SPDX-License-Identifier: LGPL-2.1-or-later
PLANE_IN(7, clusters);  // (r_cluster, index), index < 0 if there is none

/// (r_cluster, weight of the cluster prior) of pixel n (3.15).
vec4 cluster_target(int n) {
  vec4 cluster = FETCH(clusters, n);
  float weight = push.w_clustering * exp(-push.alpha_clustering * intensity(FETCH(image, n).rgb));
  return vec4(cluster.rgb, cluster.w < 0.0 ? 0.0 : weight);
}
