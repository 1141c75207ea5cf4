// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/finite.glsl"
#include "camera/camera.glsl"
#include "camera/known_surface.glsl"
#include "camera/voxel.glsl"

// The share of all light that an object hides from what a frame sees of its scene, at every kCastStep-th pixel of the view: one an
// invocation.
//
//   sum over beams of light on the surface × share of the beam's rays that meet the object / sum of light on the surface
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
  uvec2 size;  // of the view
  uint table_mask;
  float voxel;
  float truncation;
  float strength;
  float softness;  // added to the distance of rays from the axis of their beam, radii of the object
} push;
#include "camera/find_block.glsl"
#include "camera/shadow.glsl"
#include "room.glsl"

const uint kCastStep = 2u;        // pixels of the view; edges of shadows are about as wide, unless they are far
const int kRays = 16, kSteps = 6;  // of a beam; along a ray, from the surface to the object's top
const float kBias = 0.01;          // radii
const float kLift = 1.5;           // voxels, of rays off the surface
const float kSeenAtAll = 0.01;     // of a beam: less does not count

// Points of the unit disk, alike far apart (Vogel 1979).
vec2 ray(int i) { return sqrt((float(i) + 0.5) / float(kRays)) * vec2(cos(2.399963 * float(i)), sin(2.399963 * float(i))); }

// Coverage by the object at a place of the map of a beam, in radii, if it is there between two heights.
float object_at(int k, vec2 at, float low, float high) {
  ivec2 pixel = ivec2(floor(vec2(at.x, -at.y) * kMapScale + 0.5 * float(kMapSide)));
  bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(kMapSide)));
  pixel = clamp(pixel, ivec2(0), ivec2(kMapSide - 1)) + kMapSide * ivec2(k % kMapColumns, k / kMapColumns);
  int i = pixel.y * kMapSide * kMapColumns + pixel.x;
  vec2 front = FETCH(maps, i).xy;
  float back = -FETCH(maps, i + kMapRows * kMapColumns * kMapSide * kMapSide).x;
  return inside && front.x > low * kMapScale && back < high * kMapScale ? front.y : 0.0;
}

float hidden_by(int k, vec3 place, vec3 normal) {
  vec4 object = FETCH(room, kObject), x = beam(k, 1);
  vec3 off = (place - object.xyz) / object.w, z = beam(k, 3).xyz;
  vec2 at = vec2(dot(off, x.xyz), dot(off, beam(k, 2).xyz));
  float height = dot(off, z);
  if (height > 1.0 || max(abs(at.x), abs(at.y)) > 1.0 + x.w * (1.0 - height) + push.softness) return 0.0;
  float low = max(height + kBias, -1.0), size = (1.0 - low) / float(kSteps), share = 0.0;
  for (int i = 0; i < kRays; ++i) {
    float covered = 0.0;
    for (int n = 0; n < kSteps; ++n) {
      float from = low + float(n) * size, middle = from + 0.5 * size;
      covered = max(covered, object_at(k, at + (x.w * (middle - height) + push.softness) * ray(i), from, from + size));
    }
    share += covered / float(kRays);
  }
  float light = light_of_beam(k, normal);
  if (share < kSeenAtAll || light <= 0.0) return 0.0;
  return light * share * lit_share(place / push.voxel + kLift * normal, z, max(-height, 0.0) * object.w / push.voxel, 0.0);
}

void main() {
  uint line = line_index();
  uvec2 grid = (push.size + kCastStep - 1u) / kCastStep, pixel = kCastStep * uvec2(line % grid.x, line / grid.x);
  if (pixel.y >= push.size.y) return;
  vec4 seen = known_surface(FETCH(surface, int(pixel.y * push.size.x + pixel.x))), rotation = FETCH(room, kRotation);
  float share = 0.0;
  if (seen.w > 0.0) {
    vec3 place = to_world(rotation, FETCH(room, kPlace), seen.w * ray_of(push.lens, vec2(pixel)));
    vec3 normal = turned(rotation, seen.xyz);
    for (int k = 0; k < beam_count(); ++k) share += hidden_by(k, place, normal);
    float all = 0.0;
    for (int k = 0; k < beam_count() && share > 0.0; ++k) all += light_of_beam(k, normal);
    share /= max(all, 1e-20);
  }
  STORE(hidden, line, vec4(vec3(push.strength * min(share, 1.0)), seen.w));
}
