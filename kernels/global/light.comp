#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "global.glsl"

// Tint of the light at the points of the grid, and the histogram of the chroma that it leaves: direct light, which shows the true
// color, counts more. One point an invocation.
PLANE_IN(0, cues);
PLANE_IN(1, lights);
PLANE_IN(2, scene);
PLANE_OUT(3, lit);          // t, indirect fraction, weight
WORD_INOUT(4, histogram);   // kBins, fixed point, starts at 0
layout(push_constant) uniform Push { uint count; } push;

const float kFixed = 262144.0;  // 2^18: weights add up to at most the number of points

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  vec4 cue = FETCH(cues, int(i)), light = FETCH(lights, int(i));
  vec3 tint = tint_of(light.w, FETCH(scene, SCENE_AMOUNT).x * light.rgb);
  float weight = (0.5 + 0.5 * cue.z / FETCH(scene, SCENE_STATE).y) / (1.0 + 9.0 * tint.z * tint.z);
  STORE(lit, i, vec4(tint, weight));
  vec4 hats;
  uint bin = bins_around(cue.xy - tint.xy, hats);
  uvec4 share = uvec4(round(kFixed * weight * hats));
  atomicAdd(LOAD(histogram, bin), share.x);
  atomicAdd(LOAD(histogram, bin + 1u), share.y);
  atomicAdd(LOAD(histogram, bin + kSide), share.z);
  atomicAdd(LOAD(histogram, bin + kSide + 1u), share.w);
}
