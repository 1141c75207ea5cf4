#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../image/workgroup_sum.glsl"
#include "global.glsl"

// What an amount of indirect light costs: the entropy of the histogram of the chroma that it leaves, less the share that is
// neutral. One amount a workgroup.
PLANE_IN(0, cues);
PLANE_IN(1, lights);
SCALAR_OUT(2, costs);
layout(push_constant) uniform Push {
  uint count;
  float neutral;        // weight
  float neutral_width;  // -1 / (2 width^2)
} push;

const float kFixed = 131072.0;  // 2^17: a grid of 6400 points of weight 1 stays below 2^32
shared uint bins[kBins];

void main() {
  for (uint b = gl_LocalInvocationIndex; b < kBins; b += gl_WorkGroupSize.x) bins[b] = 0u;
  barrier();
  float amount = candidate(gl_WorkGroupID.x);
  vec4 sum = vec4(0.0);  // neutral weight, weight, mass of the bins
  for (uint i = gl_LocalInvocationIndex; i < push.count; i += gl_WorkGroupSize.x) {
    vec4 cue = FETCH(cues, int(i)), light = FETCH(lights, int(i));
    vec2 left = cue.xy - tint_of(light.w, amount * light.rgb).xy;
    vec4 hats;
    uint bin = bins_around(left, hats);
    uvec4 share = uvec4(round(kFixed * cue.z * hats));
    atomicAdd(bins[bin], share.x);
    atomicAdd(bins[bin + 1u], share.y);
    atomicAdd(bins[bin + kSide], share.z);
    atomicAdd(bins[bin + kSide + 1u], share.w);
    sum.xy += cue.z * vec2(exp(push.neutral_width * dot(left, left)), 1.0);
    sum.z += float(share.x + share.y + share.z + share.w);
  }
  sum = workgroup_sum(sum);
  vec4 entropy = vec4(0.0);
  for (uint b = gl_LocalInvocationIndex; b < kBins; b += gl_WorkGroupSize.x) {
    float p = float(bins[b]) / max(sum.z, 1.0);
    entropy.x -= p > 0.0 ? p * log(p) : 0.0;
  }
  entropy = workgroup_sum(entropy);
  if (gl_LocalInvocationIndex == 0u)
    STORE(costs, gl_WorkGroupID.x, entropy.x - push.neutral * sum.x / (sum.y + 1e-9));
}
