// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "edit.glsl"

// One workgroup: the base colors of light after an edit, and their change,
//
//   b'_k = b_k + strength w_k (s_k a − b_k).
//
// After an edit of surfaces (kBySurface), w_k is the selected share of the light of base color k's own surfaces, Σ sel I / Σ I over
// a sample of the pixels whose unedited reflectance is nearest to the unedited b_k in chromaticity, I = mean R S; and
// s_k = b_k·key / key·key, so that the key's light becomes the target's. Changed light is reflected again and again: with the share
// p of bounced light, Σ S (mean L − direct) / Σ S mean L, light changes by Δb_k (1 + p + p² …). Else base colors are selected
// directly, by chromaticity or by index, and s_k = mean b_k: a color of mean 1 keeps their brightness.
layout(constant_id = 1) const uint kBy = 0u;
const uint kBySurface = 0u, kByKey = 1u, kByIndex = 2u, kByClustersSurface = 3u, kByBasesSurface = 4u;
PLANE_IN(0, bases);
PLANE_IN(1, model);      // R.rgb, S before any edit
PLANE_IN(2, selection);  // x = 0…1
PLANE_IN(3, keys);       // kByClustersSurface: Palette::colors(), whose cluster `index` is the key; kByBasesSurface: base_key.comp
PLANE_IN(4, model_bases);  // before any edit
PLANE_OUT(5, edited);
PLANE_OUT(6, change);  // b' − b, with all reflections
PLANE_IN(7, light);    // before any edit
layout(push_constant) uniform Push {
  vec4 key;  // linear RGB; w = tolerance
  vec4 target;  // a; w = strength
  uvec2 size;
  float fall_off;  // 1 / softness
  int index;
} push;

const float kTiny = 1e-6;
const float kMaxBounced = 0.75;  // of p

vec3 chroma(vec3 v) { return (v + 1e-3) / (mean3(v) + 1e-3); }

void main() {
  vec4 held[kMaxBases / 4], all[kMaxBases / 4], arriving = vec4(0.0);
  for (int q = 0; q < kMaxBases / 4; ++q) held[q] = all[q] = vec4(0.0);
  const bool by_surface = kBy == kBySurface || kBy == kByClustersSurface || kBy == kByBasesSurface;
  vec3 key = push.key.rgb;
  if (kBy == kByClustersSurface) {
    int chosen = int(FETCH(keys, push.index).w);  // the cluster it was merged into; −1: it has no pixels
    key = chosen < 0 ? vec3(0.0) : exp(FETCH(keys, kMaxClusters + chosen).rgb);
  }
  if (kBy == kByBasesSurface) key = FETCH(keys, 0).rgb;
  if (by_surface) {
    uvec2 grid = min(push.size, uvec2(kSampleSide));
    for (uint i = gl_LocalInvocationID.x; i < grid.x * grid.y; i += gl_WorkGroupSize.x) {
      uvec2 at = uvec2(i % grid.x, i / grid.x) * push.size / grid;
      int n = int(at.y * push.size.x + at.x);
      vec4 own = finite(FETCH(model, n));
      vec3 c = chroma(own.rgb);
      float sent = min(mean3(own.rgb) * own.w, kLargest), nearest2 = 3.4e38;
      int nearest = -1;
      for (int k = 0; k < kMaxBases; ++k) {
        vec4 b = finite(FETCH(model_bases, k));
        vec3 off = c - chroma(b.rgb);
        float distance2 = dot(off, off);
        if (b.w > 0.0 && distance2 < nearest2) {
          nearest2 = distance2;
          nearest = k;
        }
      }
      vec4 seen = finite(FETCH(light, n));
      arriving.xy += min(min(own.w, kLargest) * vec2(mean3(seen.rgb), min(seen.w, mean3(seen.rgb))), kLargest);
      float selected = sent * min(finite(FETCH(selection, n)).x, 1.0);
      for (int q = 0; q < kMaxBases / 4; ++q) {
        vec4 here = vec4(equal(ivec4(4 * q) + ivec4(0, 1, 2, 3), ivec4(nearest)));
        all[q] += here * sent;
        held[q] += here * selected;
      }
    }
    for (int q = 0; q < kMaxBases / 4; ++q) {
      all[q] = workgroup_sum(all[q]);
      held[q] = workgroup_sum(held[q]);
    }
  }
  float again = 1.0;
  if (by_surface) {
    arriving = workgroup_sum(arriving);
    again = 1.0 / (1.0 - clamp(1.0 - arriving.y / (arriving.x + kTiny), 0.0, kMaxBounced));
  }
  if (gl_LocalInvocationID.x > 0u) return;
  for (int k = 0; k < kMaxBases; ++k) {
    vec4 b = finite(FETCH(bases, k));
    float w = 0.0, s = mean3(b.rgb);
    if (by_surface) {
      w = held[k / 4][k % 4] / (all[k / 4][k % 4] + kTiny);
      s = dot(b.rgb, key) / max(dot(key, key), kTiny);
    } else if (kBy == kByKey) {
      vec3 off = chroma(b.rgb) - chroma(key);
      w = falling((sqrt(dot(off, off)) - push.key.w) * push.fall_off);
    } else {
      w = k == push.index ? 1.0 : 0.0;
    }
    vec3 to = b.w > 0.0 ? min(s * push.target.rgb, vec3(kLargest)) : b.rgb;
    vec3 delta = push.target.w * w * (to - b.rgb);
    STORE(edited, k, vec4(b.rgb + delta, b.w));
    STORE(change, k, vec4(again * delta, 0.0));
  }
}
