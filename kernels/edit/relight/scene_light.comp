// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit/edit.glsl"
#include "volume/camera.glsl"
#include "volume/noise.glsl"
#include "volume/voxel.glsl"
#include "relight.glsl"

// Light of lamps in a remembered scene on what a frame sees of it, with shadows. One pixel of the view an invocation.
//
//   E = sum over lamps of light_of(lamp) · lit_share(place, lifted along the normal; lamp)
PLANE_IN(0, lamps);    // as place.comp leaves them
PLANE_IN(1, surface);  // SeenScene
PLANE_IN(2, pose);
WORD_IN(3, table);
WORD_IN(4, voxels);
PLANE_OUT(5, light);   // rgb; w: depth, meters, 0: nothing is known
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  int first, count;  // lamps
  uint table_mask;
  float voxel;
  float truncation;
  uint shadows;
} push;
#include "volume/find_block.glsl"
#include "volume/shadow.glsl"
#include "lamp_light.glsl"

const float kLift = 1.5;      // voxels from the surface to where rays start, at least
const float kClear = 2.0;     // voxels before a lamp where rays end
const float kSunReach = 12.0; // meters that rays to directional lamps go
const float kMinReach = 1.0, kMaxReach = 3.0;  // voxels to both sides from which normals are taken, ...
const float kNoiseReach = 1.5;                 // ... standard deviations of the sensor in between
const float kAlike = 0.3;                      // least cosine between the view's normal and the volume's of one surface

float shadow_of(int k, vec3 place, vec3 normal, float lift) {
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
  uvec2 pixel = uvec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= push.size.y) return;
  vec4 seen = FETCH(surface, int(line)), rotation = FETCH(pose, 0);
  float depth = finite(seen).w, square = finite(vec4(dot(seen.xyz, seen.xyz))).x;
  vec3 sum = vec3(0.0);
  bool known = depth > 0.0 && depth < kLargest && square > 0.5 && square < 2.0;
  if (known) {
    vec3 place = to_world(rotation, FETCH(pose, 1), depth * ray_of(push.lens, vec2(pixel)));
    vec3 normal = turned(rotation, seen.xyz);
    // That is from pixels side by side, and rough.
    float reach = clamp(kNoiseReach * noise_at(depth) / push.voxel, kMinReach, kMaxReach);
    vec3 smooth_normal = normal_at(place / push.voxel, reach);
    if (dot(smooth_normal, normal) > kAlike) normal = smooth_normal;
    for (int k = push.first; k < push.first + push.count; ++k) {
      vec3 added = light_of(k, place, normal);
      if (added != vec3(0.0)) sum += push.shadows == 1u ? added * shadow_of(k, place, normal, max(kLift, reach)) : added;
    }
  }
  STORE(light, line, vec4(min(sum, vec3(kLargest)), known ? depth : 0.0));
}
