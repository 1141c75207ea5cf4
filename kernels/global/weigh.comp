#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../image/workgroup_sum.glsl"
#include "model.glsl"
#include "counts.glsl"

// One workgroup: what every candidate amount costs, the entropy of its histogram less the share that is neutral, mixed with
// what it cost before; and the amount: the mean of ln kappa under the likelihood exp(-trust cost) and a normal prior, with
// how much narrower it is than the prior.
WORD_IN(0, counts);
PLANE_INOUT(1, scene);
layout(push_constant) uniform Push {
  float ln_least, ln_ratio;  // of candidates
  float neutral;             // weight of neutrality
  float ln_typical, spread;  // the prior
  float trust;
  float manual;  // above 0: the amount
} push;

void main() {
  float cost[kCandidates];
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
  float least = 3e38, renew = LOAD(scene, SCENE_TIME).z;
  for (int k = 0; k < kCandidates; ++k) {
    float before = LOAD(scene, SCENE_COSTS + k / 4)[k % 4];
    cost[k] = mix(before, cost[k], renew);
    LOAD(scene, SCENE_COSTS + k / 4)[k % 4] = cost[k];
    float off = (push.ln_least + float(k) * push.ln_ratio - push.ln_typical) / push.spread;
    least = min(least, push.trust * cost[k] + 0.5 * off * off);
  }
  vec3 seen = vec3(0.0), blind = vec3(0.0);  // moments of ln kappa
  for (int k = 0; k < kCandidates; ++k) {
    float ln = push.ln_least + float(k) * push.ln_ratio, off = (ln - push.ln_typical) / push.spread;
    float prior = exp(-0.5 * off * off), likely = exp(least - push.trust * cost[k] - 0.5 * off * off);
    seen += likely * vec3(1.0, ln, ln * ln);
    blind += prior * vec3(1.0, ln, ln * ln);
  }
  seen.yz /= seen.x;
  blind.yz /= blind.x;
  float variance = max(0.0, seen.z - seen.y * seen.y);
  float confidence = clamp(1.0 - variance / (blind.z - blind.y * blind.y), 0.0, 1.0);
  // What hardly any color is left to see by goes before the color does.
  float usable = LOAD(scene, SCENE_TINT).z;
  LOAD(scene, SCENE_AMOUNT).xy = push.manual > 0.0 ? vec2(push.manual, 1.0) : usable * vec2(exp(seen.y), confidence);
}
