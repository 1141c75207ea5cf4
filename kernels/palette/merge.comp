// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "palette.glsl"

// One invocation: merges duplicate clusters into the one of lowest index, so that indices stay the same from frame to frame. Writes
// two vectors a cluster: (merged color, index that it was merged into, −1 without pixels) and, kMaxClusters later, (ln color in the
// solver's scale, 1 if it is not merged).
PLANE_IN(0, clusters);
SCALAR_IN(1, scale);
PLANE_OUT(2, palette);

float mean3(vec3 v) { return (v.r + v.g + v.b) * (1.0 / 3.0); }

void main() {
  if (line_index() != 0u) return;
  float g = FETCH1(scale, 0);
  uint merged = 0u;  // bit per cluster that is done
  for (int a = 0; a < push.clusters; ++a) {
    vec4 into = FETCH(clusters, a);
    bool alive = into.w > 0.0;
    bool stands = alive && (merged & (1u << a)) == 0u;
    if (!alive) STORE(palette, a, vec4(0.0, 0.0, 0.0, -1.0));
    float mean_a = mean3(into.rgb) + push.chroma_floor;
    vec4 sum = vec4(0.0);
    uint joined = 0u;
    for (int b = a; b < push.clusters && stands; ++b) {
      vec4 other = FETCH(clusters, b);
      float mean_b = mean3(other.rgb) + push.chroma_floor;
      vec3 d = (into.rgb + push.chroma_floor) / mean_a - (other.rgb + push.chroma_floor) / mean_b;
      bool same = sqrt(dot(d, d)) < push.tau_cc && abs(log(mean_a / mean_b)) < push.tau_intensity;
      if (other.w > 0.0 && (merged & (1u << b)) == 0u && (same || b == a)) {
        joined |= 1u << b;
        sum += other.w * vec4(other.rgb, 1.0);
      }
    }
    vec3 color = sum.rgb / max(sum.w, 1e-30);
    for (int b = a; b < push.clusters && stands; ++b) {
      if ((joined & (1u << b)) != 0u) STORE(palette, b, vec4(color, float(a)));
    }
    merged |= joined;
    STORE(palette, kMaxClusters + a, vec4(log(max(color, 1e-3)) - g, stands ? 1.0 : 0.0));
  }
}
