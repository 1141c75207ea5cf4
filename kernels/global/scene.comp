#version 450
#extension GL_GOOGLE_include_directive : require
#include "../gpu/common.glsl"
#include "../image/workgroup_sum.glsl"
#include "global.glsl"

// Whether a frame continues the one before, by the change of its chroma; and means over it. One workgroup.
PLANE_IN(0, points);
PLANE_IN(1, cues);
PLANE_IN(2, before);  // cues of the frame before
PLANE_INOUT(3, scene);
layout(push_constant) uniform Push {
  uint count;
  uint first;
  float renew;
  float cut;
} push;

void main() {
  vec4 light = vec4(0.0), change = vec4(0.0);
  for (uint i = gl_LocalInvocationIndex; i < push.count; i += gl_WorkGroupSize.x) {
    vec4 cue = FETCH(cues, int(i));
    light += vec4(FETCH(points, int(i)).rgb, cue.z);
    change.x += cue.z * min(distance(cue.xy, FETCH(before, int(i)).xy) / 0.5, 1.0);
  }
  light = workgroup_sum(light);
  change = workgroup_sum(change);
  if (gl_LocalInvocationIndex != 0u) return;
  bool anew = push.first != 0u || change.x > push.cut * (light.w + 1e-9);
  float frames = anew ? 0.0 : LOAD(scene, SCENE_STATE).z;
  LOAD(scene, SCENE_STATE) = vec4(anew ? 1.0 : 0.0, light.w / float(push.count) + 1e-9, frames + 1.0,
                                  max(push.renew, 1.0 / (frames + 1.0)));
  LOAD(scene, SCENE_MEAN) = light / float(push.count);
}
