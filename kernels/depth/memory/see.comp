// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/same_surface.glsl"
#include "depth/tracking/tracking.glsl"

// What a frame sees, for who works on its layers: the view of the scene, and what the depth image has where nothing is remembered or
// something else is in front of it. One pixel an invocation.
const uint kPoseRows = 3u;

PLANE_IN(0, view);       // normal and depth of the remembered scene
PLANE_IN(1, measured);   // of the frame
PLANE_IN(2, camera);     // pose
PLANE_IN(3, found);      // tracking.glsl
PLANE_OUT(4, surface);
PLANE_OUT(5, pose);      // and whether it is known
layout(push_constant) uniform Push { uint pixels; } push;

bool has_normal(vec4 seen) { return seen.w > 0.0 && dot(seen.xyz, seen.xyz) > 0.0; }

void main() {
  uint at = line_index();
  if (at >= push.pixels) return;
  bool known = FETCH(found, int(kFound)).x > 0.0;
  vec4 there = FETCH(view, int(at)), here = FETCH(measured, int(at));
  bool other = has_normal(here) && !(has_normal(there) && same_surface(here.w, there.w));
  vec4 seen = other ? here : there;
  STORE(surface, at, known && has_normal(seen) ? seen : vec4(0.0));
  if (at > 0u) return;
  STORE(pose, 0, FETCH(camera, 0));
  STORE(pose, 1, FETCH(camera, 1));
  STORE(pose, 2, vec4(known ? 1.0 : 0.0, 0.0, 0.0, 0.0));
}
