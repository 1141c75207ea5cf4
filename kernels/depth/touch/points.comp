// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "camera/camera.glsl"
#include "touch.glsl"

// Where skin in front of the scene is near it: sums over a tile of the nearest places of the scene, weighted by (1 - d / kNear)². A
// workgroup of 64 a tile, one pixel an invocation.
WORD_IN(0, kinds);
PLANE_IN(1, surface);      // of the frame: w: depth
SCALAR_IN(2, view_depth);
PLANE_IN(3, view_surface);  // xyz: normal, in the camera's axes
PLANE_IN(4, reflectance);   // of the view: ln R; w: confidence
PLANE_OUT(5, sums);         // TOUCH_STRIDE a tile
layout(push_constant) uniform Push {
  vec4 lens;
  uvec2 size;
} push;

const float kNear = 0.022;  // meters: a finger and some
const float kAbove = 0.5;   // of the distance, along the normal: what continues the surface, or lies behind it, is part of the scene
const int kSide = 4;        // places on each side of a pixel where the scene is looked at

void main() {
  uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, across = (push.size.x + TOUCH_TILE - 1u) / TOUCH_TILE;
  uint tiles = across * ((push.size.y + TOUCH_TILE - 1u) / TOUCH_TILE), own = gl_LocalInvocationIndex;
  ivec2 pixel = ivec2(TOUCH_TILE * uvec2(tile % across, tile / across) + uvec2(own % TOUCH_TILE, own / TOUCH_TILE)), last = ivec2(push.size) - 1;
  bool inside = tile < tiles && pixel.x <= last.x && pixel.y <= last.y;
  int at = inside ? pixel.y * int(push.size.x) + pixel.x : 0;
  uint kind = inside ? FETCH1(kinds, at) : 0u;
  float z = FETCH(surface, at).w;
  vec4 place = vec4(0.0), color = place, counts = vec4(0.0, 0.0, (kind & TOUCH_FRONT) != 0u, inside && z > 0.0);
  if ((kind & (TOUCH_FRONT | TOUCH_SKIN)) == (TOUCH_FRONT | TOUCH_SKIN)) {
    vec3 here = z * ray_of(push.lens, vec2(pixel)), nearest = here;
    vec2 stride = max(ceil(kNear * abs(push.lens.xy) / (z * float(kSide))), vec2(1.0));
    float distance_there = kNear;
    int from = -1;
    for (int dy = -kSide; dy <= kSide; ++dy)
      for (int dx = -kSide; dx <= kSide; ++dx) {
        vec2 to = vec2(pixel) + stride * vec2(dx, dy);
        if (any(lessThan(to, vec2(0.0))) || any(greaterThan(to, vec2(last)))) continue;
        int there = int(to.y) * int(push.size.x) + int(to.x);
        float depth = FETCH1(view_depth, there);
        vec3 point = depth * ray_of(push.lens, to);
        float d = distance(point, here);
        if (!(depth > 0.0) || !(d < distance_there)) continue;
        distance_there = d;
        nearest = point;
        from = there;
      }
    if (from >= 0 && dot(here - nearest, FETCH(view_surface, from).xyz) > kAbove * distance_there) {
      float share = 1.0 - distance_there / kNear, weight = share * share;
      vec4 r = FETCH(reflectance, from);
      place = weight * vec4(nearest, 1.0);
      color = r.w > 0.0 ? weight * vec4(r.rgb, 1.0) : vec4(0.0);
      counts.xy = vec2(weight * distance_there, 1.0);
    }
  }
  place = workgroup_sum(place);
  color = workgroup_sum(color);
  counts = workgroup_sum(counts);
  if (own != 0u || tile >= tiles) return;
  STORE(sums, TOUCH_STRIDE * tile, place);
  STORE(sums, TOUCH_STRIDE * tile + 1u, color);
  STORE(sums, TOUCH_STRIDE * tile + 2u, counts);
}
