// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/camera.glsl"

// Whether a view is to be rendered anew, and if so its pose: that of the camera. One invocation.
PLANE_IN(0, pose);
PLANE_INOUT(1, view_pose);
WORD_OUT(2, outdated);  // 0 or 1
layout(push_constant) uniform Push {
  float max_turn;   // radians by which the camera may have turned since
  float max_shift;  // meters
  uint changed;     // whether the scene or the lens has changed since
} push;

void main() {
  if (line_index() != 0u) return;
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1), before = LOAD(view_pose, 0u);
  vec3 shift = place.xyz - LOAD(view_pose, 1u).xyz;
  float half_turn = length(product(rotation, vec4(-before.xyz, before.w)).xyz);  // its sine
  bool same = push.changed == 0u && half_turn <= sin(0.5 * push.max_turn) && dot(shift, shift) <= push.max_shift * push.max_shift;
  STORE(outdated, 0, same ? 0u : 1u);
  if (same) return;
  STORE(view_pose, 0u, rotation);
  STORE(view_pose, 1u, place);
}
