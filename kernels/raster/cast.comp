// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"
#include "volume/camera.glsl"
#include "volume/voxel.glsl"

// The share of all light that an object hides from what a frame sees of its scene (soft shadow maps after Fernando 2005). One pixel of the
// view an invocation.
//
//   sum over beams of light on the surface × share of the beam's width that meets the object / sum of light on the surface
//
// Light that the scene keeps from the surface on its way from the object does not count.
PLANE_IN(0, room);
PLANE_IN(1, surface);  // SeenScene
PLANE_IN(2, maps);     // x: height of the object towards the light, of its other side away from it, pixels of the map; y: coverage
WORD_IN(3, table);
WORD_IN(4, voxels);
PLANE_OUT(5, hidden);  // x; w: depth, meters, 0: nothing is known
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
  uint table_mask;
  float voxel;
  float truncation;
  float strength;
  float softness;  // added to the radius of what a beam is, radii of the object
} push;
#include "volume/find_block.glsl"
#include "volume/shadow.glsl"
#include "room.glsl"

const int kTaps = 24;
const float kBias = 0.01;      // radii
const float kLift = 1.5;       // voxels, of rays off the surface
const float kSeenAtAll = 0.004;  // of the light: less is not traced

// Points of the unit disk, alike far apart (Vogel 1979).
vec2 tap(int i) { return sqrt((float(i) + 0.5) / float(kTaps)) * vec2(cos(2.399963 * float(i)), sin(2.399963 * float(i))); }

// Height of the middle of the object in the map of a beam, at a place in radii, and coverage. None that is not above `above`.
vec2 object_at(int k, vec2 at, float above) {
  ivec2 pixel = ivec2(floor(vec2(at.x, -at.y) * kMapScale + 0.5 * float(kMapSide)));
  bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(kMapSide)));
  pixel = clamp(pixel, ivec2(0), ivec2(kMapSide - 1)) + kMapSide * ivec2(k % kMapColumns, k / kMapColumns);
  int i = pixel.y * kMapSide * kMapColumns + pixel.x;
  vec2 front = FETCH(maps, i).xy;
  float back = -FETCH(maps, i + kMapRows * kMapColumns * kMapSide * kMapSide).x;
  return vec2(max(0.5 * (front.x + back) / kMapScale, above), inside && front.x / kMapScale > above ? front.y : 0.0);
}

float hidden_by(int k, vec3 place, vec3 normal, float light) {
  vec4 object = FETCH(room, kObject), x = beam(k, 1);
  vec3 off = (place - object.xyz) / object.w, z = beam(k, 3).xyz;
  vec2 at = vec2(dot(off, x.xyz), dot(off, beam(k, 2).xyz));
  float height = dot(off, z), width = x.w * max(1.0 - height, 0.0) + push.softness;
  if (height > 1.0 || max(abs(at.x), abs(at.y)) > 1.0 + width) return 0.0;
  float sum = 0.0, total = 0.0;
  for (int i = 0; i < kTaps; ++i) {
    vec2 there = object_at(k, at + width * tap(i), height + kBias);
    sum += there.y * there.x;
    total += there.y;
  }
  if (total <= 0.0) return 0.0;
  float away = sum / total - height, share = 0.0;
  width = x.w * away + push.softness;
  for (int i = 0; i < kTaps; ++i) share += object_at(k, at + width * tap(i), height + kBias).y;
  share /= float(kTaps);
  if (share * light < kSeenAtAll) return share;
  return share * lit_share(place / push.voxel + kLift * normal, z, away * object.w / push.voxel, 0.0);
}

void main() {
  uint line = line_index();
  uvec2 pixel = uvec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= push.size.y) return;
  vec4 seen = FETCH(surface, int(line)), rotation = FETCH(room, kRotation);
  float depth = finite(seen).w, square = finite(vec4(dot(seen.xyz, seen.xyz))).x, share = 0.0;
  bool known = depth > 0.0 && depth < kLargest && square > 0.5 && square < 2.0;
  if (known) {
    vec3 place = to_world(rotation, FETCH(room, kPlace), depth * ray_of(push.lens, vec2(pixel)));
    vec3 normal = turned(rotation, seen.xyz);
    float all = 0.0;
    for (int k = 0; k < beam_count(); ++k) all += light_of_beam(k, normal);
    for (int k = 0; k < beam_count(); ++k) {
      float light = light_of_beam(k, normal) / max(all, 1e-20);
      if (light > 0.0) share += light * hidden_by(k, place, normal, light);
    }
  }
  STORE(hidden, line, vec4(vec3(push.strength * min(share, 1.0)), known ? depth : 0.0));
}
