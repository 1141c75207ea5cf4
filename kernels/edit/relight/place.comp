// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "camera/camera.glsl"
#include "relight.glsl"

// Puts lamps into the scene that a frame sees: places and directions become those of the world, marks pixels of the frame. One lamp an
// invocation. Where the camera's pose is not known, they are off.
PLANE_IN(0, lamps);   // whose kinds say what they are given in
PLANE_IN(1, pose);    // SeenScene
PLANE_OUT(2, placed);
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;   // of the frame
  uvec2 view;   // of the view of the scene
  uint count;
} push;

const float kNearest = 0.01;  // meters from the camera: nearer lamps have no mark
const float kNoMark = -1e9;   // pixels

void main() {
  int k = int(line_index());
  if (k >= int(push.count)) return;
  vec4 at = FETCH(lamps, kLampRows * k + kPlace), axis = FETCH(lamps, kLampRows * k + kAxis);
  vec4 light = FETCH(lamps, kLampRows * k + kLight), mark = FETCH(lamps, kLampRows * k + kMark);
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1);
  vec2 frame_pixels = vec2(push.size) / vec2(push.view);  // a pixel of the view
  int code = int(axis.w), kind = code % kKinds;
  bool directional = kind == kKinds - 1;
  if (code >= kOfCamera) {
    // At the depth at.z on the ray of its pixel; directions have z towards the viewer.
    vec3 ray = ray_of(push.lens, mark.xy / frame_pixels - 0.5);
    at.xyz = to_world(rotation, place, at.z * ray);
    axis.xyz = turned(rotation, vec3(axis.xy, -axis.z));
  } else if (code >= kOfRoom) {
    vec3 seen = directional ? turned(vec4(-rotation.xyz, rotation.w), axis.xyz) : to_camera(rotation, place, at.xyz);
    if (directional)
      mark.xy = 0.5 * (vec2(push.size) - float(min(push.size.x, push.size.y)) * seen.xy);
    else
      mark.xy = seen.z > kNearest ? (projected(push.lens, seen) + 0.5) * frame_pixels : vec2(kNoMark);
  }
  bool known = FETCH(pose, 2).x > 0.0;
  STORE(placed, kLampRows * k + kPlace, at);
  STORE(placed, kLampRows * k + kAxis, vec4(axis.xyz, float(kind)));
  STORE(placed, kLampRows * k + kLight, code < kOfRoom || known ? light : vec4(vec3(0.0), light.w));
  STORE(placed, kLampRows * k + kMark, vec4(code < kOfRoom || known ? mark.xy : vec2(kNoMark), mark.zw));
}
