// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "global/model/model.glsl"
#include "global/model/counts.glsl"

// One workgroup: the cost of every candidate amount, the entropy of its histogram less the neutral share, averaged over time; and
// the amount: the mean of ln kappa under the likelihood exp(-measurement_weight cost) and a normal prior, and how much narrower the posterior is
// than the prior. Colors of small spread are moved alike by any tint, past the borders of bins and towards gray, which is no
// evidence: the smaller the spread of chroma, the less a difference of cost counts; but not for the color of light.
WORD_IN(0, counts);
PLANE_INOUT(1, scene);
layout(push_constant) uniform Push {
  float ln_min, ln_ratio;  // of candidates
  float neutral;             // weight of neutrality
  float ln_typical, spread;  // the prior
  float measurement_weight, full_spread;  // from this spread of chroma on; below, in proportion to it
  float manual;             // above 0: the amount
  float renew_color;        // min share of the newest frame in the confidence of the color of light
} push;

const float kSure = 0.06;  // confidence that is enough for the color

float cost[kCandidates];

// Mean and variance of ln kappa.
vec2 moments(float measurement_weight) {
  float min_cost = 3e38;
  for (int k = 0; k < kCandidates; ++k) {
    float off = (push.ln_min + float(k) * push.ln_ratio - push.ln_typical) / push.spread;
    min_cost = min(min_cost, measurement_weight * cost[k] + 0.5 * off * off);
  }
  vec3 sum = vec3(0.0);
  for (int k = 0; k < kCandidates; ++k) {
    float ln = push.ln_min + float(k) * push.ln_ratio, off = (ln - push.ln_typical) / push.spread;
    sum += exp(min_cost - measurement_weight * cost[k] - 0.5 * off * off) * vec3(1.0, ln, ln * ln);
  }
  vec2 mean = sum.yz / sum.x;
  return vec2(mean.x, max(0.0, mean.y - mean.x * mean.x));
}

void main() {
  for (int k = 0; k < kCandidates; ++k) {
    // sum p ln p = sum c ln c / all - ln all
    vec4 sum = vec4(0.0);
    for (int b = int(gl_LocalInvocationID.x); b < kBinCount; b += int(gl_WorkGroupSize.x)) {
      float c = float(FETCH1(counts, k * kBinCount + b)) / kCountUnit;
      if (c > 0.0) sum += vec4(c * log(c), c, 0.0, 0.0);
    }
    sum = workgroup_sum(sum);
    float all = max(sum.y, 1e-9);
    int sums = kCandidates * kBinCount + 2 * k;
    cost[k] = log(all) - sum.x / all -
              push.neutral * float(FETCH1(counts, sums)) / max(float(FETCH1(counts, sums + 1)), 1e-4);
  }
  if (gl_LocalInvocationID.x > 0u) return;
  float renew = LOAD(scene, SCENE_TIME)[TIME_SHARE];
  for (int k = 0; k < kCandidates; ++k) {
    float before = LOAD(scene, SCENE_COSTS + k / 4)[k % 4];
    cost[k] = mix(before, cost[k], renew);
    LOAD(scene, SCENE_COSTS + k / 4)[k % 4] = cost[k];
  }
  // Estimates lose their weight before the color is gone.
  float usable = LOAD(scene, SCENE_TINT)[TINT_USABLE], spread = LOAD(scene, SCENE_TINT)[TINT_SPREAD];
  vec2 blind = moments(0.0), seen = moments(push.measurement_weight * min(1.0, spread / push.full_spread)), sharp = moments(push.measurement_weight);
  vec2 confidence = usable * clamp(1.0 - vec2(seen.y, sharp.y) / blind.y, 0.0, 1.0);
  bool manual = push.manual > 0.0;
  LOAD(scene, SCENE_AMOUNT)[AMOUNT_KAPPA] = manual ? push.manual : usable * exp(seen.x);
  LOAD(scene, SCENE_AMOUNT)[AMOUNT_CONFIDENCE] = manual ? 1.0 : confidence.x;
  // Averaged over more frames than the rest, so that light that loses its color and regains it is tracked.
  float colored = smoothstep(0.0, kSure, confidence.y), share = max(push.renew_color, 1.0 / max(LOAD(scene, SCENE_TIME)[TIME_FRAMES], 1.0));
  LOAD(scene, SCENE_WHITE).z = manual ? 1.0 : mix(LOAD(scene, SCENE_WHITE).z, colored, share);
}
