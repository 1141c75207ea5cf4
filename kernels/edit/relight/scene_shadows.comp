// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit/edit.glsl"
#include "camera/camera.glsl"
#include "camera/known_surface.glsl"
#include "camera/noise.glsl"
#include "camera/voxel.glsl"
#include "relight.glsl"

// How much of each lamp in a remembered scene arrives at every second pixel of what a frame sees of it, and the normals there. Edges
// of shadows are wider than two pixels unless the surface is far. One of these pixels an invocation.
PLANE_IN(0, lamps);    // as place.comp leaves them
PLANE_IN(1, surface);  // SeenScene
PLANE_IN(2, pose);
WORD_IN(3, table);
WORD_IN(4, voxels);
PLANE_OUT(5, normals);  // in the world; w: depth, meters, 0: nothing is known
WORD_OUT(6, shares);    // kShareWords a pixel, a byte a lamp: 255: all of it
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;  // of the view
  int first, count;  // lamps
  uint table_mask;
  float voxel;
  float truncation;
  uint shadows;  // 0: all arrives
} push;
#include "camera/find_block.glsl"
#include "camera/shadow.glsl"
#include "lamp_light.glsl"

const float kLift = 1.5;      // voxels from the surface to where rays start, at least
const float kClear = 2.0;     // voxels before a lamp where rays end
const float kSunReach = 12.0; // meters that rays to directional lamps go
const float kMinReach = 1.0, kMaxReach = 3.0;  // voxels to both sides from which normals are taken, ...
const float kNoiseReach = 1.5;                 // ... standard deviations of the sensor in between

float share_of(int k, vec3 place, vec3 normal, float lift) {
  vec4 lamp = FETCH(lamps, kLampRows * k + kPlace), axis = FETCH(lamps, kLampRows * k + kAxis);
  vec3 from = place + lift * push.voxel * normal;
  if (int(axis.w) == kDirectional) return lit_share(from / push.voxel, -axis.xyz, kSunReach / push.voxel, 0.0);
  vec3 to = lamp.xyz - from;
  float way = length(to), radius = sqrt(lamp.w), reach = way - max(radius, kClear * push.voxel);
  if (!(reach > 0.0)) return 1.0;
  return lit_share(from / push.voxel, to / way, reach / push.voxel, radius / way);
}

void main() {
  uint line = line_index();
  uvec2 grid = (push.size + kShareStep - 1u) / kShareStep, at = uvec2(line % grid.x, line / grid.x);
  if (at.y >= grid.y) return;
  uvec2 pixel = kShareStep * at;
  vec4 seen = known_surface(FETCH(surface, int(pixel.y * push.size.x + pixel.x)));
  uvec2 words = uvec2(0xffffffffu);
  vec3 normal = vec3(0.0);
  if (seen.w > 0.0) {
    vec4 rotation = FETCH(pose, 0);
    vec3 place = to_world(rotation, FETCH(pose, 1), seen.w * ray_of(push.lens, vec2(pixel)));
    normal = turned(rotation, seen.xyz);
    // That is from pixels side by side, and rough.
    float reach = clamp(kNoiseReach * noise_at(seen.w) / push.voxel, kMinReach, kMaxReach);
    vec3 smooth_normal = normal_at(place / push.voxel, reach);
    if (dot(smooth_normal, normal) > kAlike) normal = smooth_normal;
    for (int k = 0; k < push.count && push.shadows == 1u; ++k) {
      if (light_of(push.first + k, place, normal) == vec3(0.0)) continue;
      uint share = uint(255.0 * share_of(push.first + k, place, normal, max(kLift, reach)) + 0.5);
      uint shift = 8u * uint(k & 3);
      words[k >> 2] = words[k >> 2] & ~(255u << shift) | share << shift;
    }
  }
  STORE(normals, line, vec4(normal, seen.w));
  STORE(shares, kShareWords * line, words.x);
  STORE(shares, kShareWords * line + 1u, words.y);
}
