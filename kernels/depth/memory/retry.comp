// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "depth/tracking/tracking.glsl"

// The pose to look for a lost camera from: the candidate, unless the last frame was found after all, which the host does not know yet.
// One invocation.
PLANE_IN(0, found);
PLANE_IN(1, candidate);
PLANE_INOUT(2, pose);

void main() {
  if (line_index() != 0u || FETCH(found, int(kFound)).x > 0.0) return;
  STORE(pose, 0, FETCH(candidate, 0));
  STORE(pose, 1, FETCH(candidate, 1));
}
