#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// The amount: the mean of its logarithm under -trust cost and a normal prior, and how much less it varies than under that prior
// alone. One invocation.
SCALAR_IN(0, costs);
SCALAR_INOUT(1, carried);
PLANE_INOUT(2, scene);
layout(push_constant) uniform Push {
  float manual;
  float typical;
  float spread;
  float trust;
} push;

void main() {
  if (gl_GlobalInvocationID.x != 0u) return;
  vec4 state = LOAD(scene, SCENE_STATE);
  float cost[kCandidates];
  float least = 1e30;
  for (uint i = 0u; i < kCandidates; ++i) {
    float before = state.x > 0.0 ? 0.0 : LOAD(carried, i);
    float now = before + (state.x > 0.0 ? 1.0 : state.w) * (FETCH1(costs, int(i)) - before);
    LOAD(carried, i) = now;
    float off = log(candidate(i) / push.typical) / push.spread;
    cost[i] = push.trust * now + 0.5 * off * off;
    least = min(least, cost[i]);
  }
  vec3 seen = vec3(0.0), blind = vec3(0.0);
  for (uint i = 0u; i < kCandidates; ++i) {
    float k = log(candidate(i)), off = log(candidate(i) / push.typical) / push.spread;
    seen += exp(least - cost[i]) * vec3(1.0, k, k * k);
    blind += exp(-0.5 * off * off) * vec3(1.0, k, k * k);
  }
  seen.yz /= seen.x;
  blind.yz /= blind.x;
  float doubt = max(seen.z - seen.y * seen.y, 0.0) / (blind.z - blind.y * blind.y);
  LOAD(scene, SCENE_AMOUNT) = push.manual > 0.0 ? vec4(push.manual, 1.0, 0.0, 0.0)
                                                : vec4(exp(seen.y), clamp(1.0 - doubt, 0.0, 1.0), 0.0, 0.0);
}
