#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// Three steps of a guided filter of the residual by itself, each a mean over a window with belief as the weight (kStep):
//   0  (e, c) to what is believed: c e + (1 - c) mean; and that mean
//   1  to its linear model: slope var / (var + edge), offset (1 - slope) mean
//   2  to the mean of the models around
// One point of the grid an invocation.
layout(constant_id = 1) const uint kStep = 0;
PLANE_IN(0, source);
PLANE_IN(1, residual);  // .z: belief
PLANE_IN(2, lit);
PLANE_OUT(3, target);
PLANE_OUT(4, means);    // step 0: tint of the light, that mean
layout(push_constant) uniform Push {
  uvec2 size;
  int radius;
  float edge;
} push;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.size.x * push.size.y) return;
  ivec2 at = ivec2(place_of(i, push.size.x));
  ivec2 low = max(at - push.radius, 0), high = min(at + push.radius, ivec2(push.size) - 1);
  vec4 sum = vec4(0.0);
  float believed = 0.0;
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) {
      int j = y * int(push.size.x) + x;
      float c = FETCH(residual, j).z;
      vec4 value = FETCH(source, j);
      if (kStep == 1u) value.zw = value.xy * value.xy;
      sum += c * value;
      believed += c;
    }
  if (kStep == 0u) {
    float points = float((high.x - low.x + 1) * (high.y - low.y + 1));
    vec2 mean = sum.xy / (believed + 0.05 * points);
    vec4 here = FETCH(residual, int(i));
    STORE(target, i, vec4(mix(mean, here.xy, here.z), 0.0, 0.0));
    STORE(means, i, vec4(FETCH(lit, int(i)).xy, mean));
    return;
  }
  sum /= believed + 1e-6;
  if (kStep == 1u) {
    vec2 variance = max(sum.zw - sum.xy * sum.xy, vec2(0.0)), slope = variance / (variance + push.edge);
    sum = vec4(slope, (1.0 - slope) * sum.xy);
  }
  STORE(target, i, sum);
}
