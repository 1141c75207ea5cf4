// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "global/model/model.glsl"

// One workgroup: the mean weight of the frame's points; whether the frame is a cut, by the mean change of chroma in lit points; and
// with it the share of the frame in the scene's estimates. And the spread of chroma: without spread the color of light cannot be
// estimated, and all light counts as direct. If the lamps' color is removed, the cut is decided before that (kDecide alone), the
// rest after it.
layout(constant_id = 1) const bool kDecide = true;
layout(constant_id = 2) const bool kStart = true;
PLANE_IN(0, colors);
PLANE_INOUT(1, points);  // .z becomes the shading to start from
PLANE_INOUT(2, before);  // chroma, the last frame's
PLANE_INOUT(3, scene);
layout(push_constant) uniform Push {
  int count;  // of points
  float cut;
  float renew;
  uint first;  // 1: there is no frame before
  float none, full;  // spreads of chroma up to which there is no color to go by, and from which on there is
} push;

const float kMost = 0.5;  // change of log chroma that counts fully

void main() {
  vec4 sum = vec4(0.0), moments = vec4(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    float weight = FETCH(colors, i).w;
    vec2 chroma = LOAD(points, i).xy, off = chroma - LOAD(before, i).xy;
    moments += weight * vec4(chroma, dot(chroma, chroma), 0.0);
    sum += vec4(weight, weight * min(length(off) / kMost, 1.0), 0.0, 0.0);
  }
  sum = workgroup_sum(sum);
  moments = workgroup_sum(moments) / (sum.x + 1e-9);
  float change = sum.y / (sum.x + 1e-9);
  bool cut = kDecide ? push.first == 1u || !(change <= push.cut) : LOAD(scene, SCENE_TIME)[TIME_CUT] > 0.0;
  for (int i = int(gl_LocalInvocationID.x); i < push.count; i += int(gl_WorkGroupSize.x)) {
    vec4 point = LOAD(points, i);
    if (kDecide) STORE(before, i, vec4(point.xy, 0.0, 0.0));
    if (kStart && cut) LOAD(points, i).z = point.w;
  }
  if (gl_LocalInvocationID.x > 0u) return;
  if (kDecide) {
    float frames = cut ? 1.0 : LOAD(scene, SCENE_TIME)[TIME_FRAMES] + 1.0;
    LOAD(scene, SCENE_TIME)[TIME_CUT] = cut ? 1.0 : 0.0;
    LOAD(scene, SCENE_TIME)[TIME_FRAMES] = min(frames, 1e6);
    LOAD(scene, SCENE_TIME)[TIME_SHARE] = max(push.renew, 1.0 / frames);
    LOAD(scene, SCENE_TIME)[TIME_CHANGE] = change;
  }
  if (!kStart) return;
  float spread = sqrt(max(moments.z - dot(moments.xy, moments.xy), 0.0));
  float usable = push.full > 0.0 ? smoothstep(push.none, push.full, spread) : 1.0;
  LOAD(scene, SCENE_AMOUNT)[AMOUNT_WEIGHT] = sum.x / float(push.count) + 1e-9;
  LOAD(scene, SCENE_TINT)[TINT_USABLE] = usable;
  LOAD(scene, SCENE_TINT)[TINT_SPREAD] = spread;
  if (usable > 0.0) return;
  LOAD(scene, SCENE_AMOUNT).xyw = LOAD(scene, SCENE_TINT).xyz = vec3(0.0);
  LOAD(scene, SCENE_TIME)[TIME_FRAMES] = 0.0;  // estimates from before a gray passage do not count when color comes back
  for (int s = 0; s < kSlots; ++s) STORE(scene, SCENE_COLORS + s, vec4(0.0));
}
