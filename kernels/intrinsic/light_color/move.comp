// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "light.glsl"

// Moves what is in force toward what was measured: at once in a new scene, else slowly; and white light with the exposure. One
// invocation.
PLANE_INOUT(0, light);

// k stays within this distance of its target, or within the target's standard deviation: less is no evidence.
const float kNear = 0.05;
const float kMove = 0.05, kMaxMove = 0.004;  // share of the rest a frame, and the most
const float kSameExposure = 0.02;            // by which m of white light may lag behind
const float kUnsure = 0.6, kSure = 0.4;      // standard deviation of k from which on it is 0, and up to which it counts in full

void main() {
  if (gl_GlobalInvocationID.x > 0u) return;
  vec4 now = LOAD(light, LIGHT_NOW), target = LOAD(light, LIGHT_TARGET), frame = LOAD(light, LIGHT_FRAME);
  bool jumps = frame.z != LIGHT_FOLLOW, cut = frame.z == LIGHT_NEW_SCENE, measured = target.z > 0.0, given = !measured && target.x != 0.0;
  now.z = measured ? clamp((kUnsure - target.y) / (kUnsure - kSure), 0.0, 1.0) : given ? 1.0 : 0.0;
  float goal = frame.x * now.z * target.x, off = goal - now.x;
  if (jumps) now.x = goal;
  else if (frame.x == 0.0 || now.z > 0.0 && abs(off) > max(kNear, target.y)) now.x += clamp(kMove * off, -kMaxMove, kMaxMove);
  float brighter = cut ? frame.w : sign(frame.w) * max(abs(frame.w) - kSameExposure, 0.0);
  now.y = cut ? frame.y : now.y + brighter;
  now.w = 1.0;
  STORE(light, LIGHT_NOW, now);
  STORE(light, LIGHT_FRAME, vec4(frame.xy, LIGHT_FOLLOW, frame.w - brighter));
}
