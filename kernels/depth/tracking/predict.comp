// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/camera.glsl"
#include "tracking.glsl"

// Moves the pose on by the motion between the last two frames, if both were found. One invocation.
PLANE_IN(0, found);
PLANE_INOUT(1, before);  // the pose of the frame before the last; becomes that of the last
PLANE_INOUT(2, pose);

void main() {
  if (line_index() != 0u) return;
  vec4 rotation = LOAD(pose, 0u), place = LOAD(pose, 1u), last_rotation = LOAD(before, 0u), last_place = LOAD(before, 1u);
  STORE(before, 0u, rotation);
  STORE(before, 1u, place);
  if (FETCH(found, int(kFound)).z < 2.0) return;
  STORE(pose, 0u, normalize(product(product(rotation, vec4(-last_rotation.xyz, last_rotation.w)), rotation)));
  STORE(pose, 1u, 2.0 * place - last_place);
}
