// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "camera/camera.glsl"
#include "camera/jump.glsl"

// How alike a frame and a view look where their surfaces match: the correlation of steps of ln brightness over kStep pixels, in which
// light hardly counts. One workgroup.
PLANE_IN(0, surface);      // of the frame
PLANE_IN(1, pose);         // of the frame, an estimate
PLANE_IN(2, model);        // normal and depth of the view
PLANE_IN(3, view_pose);
SCALAR_IN(4, brightness);  // ln, of the frame
SCALAR_IN(5, appearance);  // ln brightness of the view
PLANE_OUT(6, agreement);   // x: correlation; y: rms step of the frame, z: of the view; w: steps
layout(push_constant) uniform Push {
  vec4 lens;  // of both
  uvec2 size;
  float max_distance;  // meters, between points that belong together
} push;

const int kStep = 3;  // finer detail the view may lack

// Ln brightness of the view where a pixel of the frame falls; y: 0 if no surface of the view is there.
vec2 there(vec4 rotation, vec4 place, vec4 view_rotation, vec4 view_place, ivec2 pixel) {
  ivec2 last = ivec2(push.size) - 1;
  pixel = min(pixel, last);
  float depth = FETCH(surface, pixel.y * int(push.size.x) + pixel.x).w;
  vec3 in_view = to_camera(view_rotation, view_place, to_world(rotation, place, depth * ray_of(push.lens, vec2(pixel))));
  bool ahead = depth > 0.0 && in_view.z > 0.0;
  vec2 at = ahead ? projected(push.lens, in_view) : vec2(-1.0);
  bool inside = ahead && all(greaterThanEqual(at, vec2(0.0))) && all(lessThanEqual(at, vec2(last)));
  at = inside ? at : vec2(0.0);
  ivec2 low = ivec2(at), high = min(low + 1, last);
  vec2 share = at - vec2(low);
  int above = low.y * int(push.size.x), below = high.y * int(push.size.x);
  ivec4 cell = ivec4(above + low.x, above + high.x, below + low.x, below + high.x);
  vec4 b = vec4(FETCH1(appearance, cell.x), FETCH1(appearance, cell.y), FETCH1(appearance, cell.z), FETCH1(appearance, cell.w));
  vec4 z = vec4(FETCH(model, cell.x).w, FETCH(model, cell.y).w, FETCH(model, cell.z).w, FETCH(model, cell.w).w);
  bool matches = inside && all(lessThan(abs(z - in_view.z), vec4(push.max_distance)));
  return vec2(mix(mix(b.x, b.y, share.x), mix(b.z, b.w, share.x), share.y), matches);
}

void main() {
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1), view_rotation = FETCH(view_pose, 0), view_place = FETCH(view_pose, 1);
  vec4 sums = vec4(0.0);
  uint pixels = push.size.x * push.size.y;
  for (uint n = gl_LocalInvocationIndex; n < pixels; n += gl_WorkGroupSize.x) {
    ivec2 pixel = ivec2(n % push.size.x, n / push.size.x);
    vec2 here = there(rotation, place, view_rotation, view_place, pixel);
    for (int k = 0; k < 2; ++k) {
      ivec2 next = pixel + kStep * ivec2(1 - k, k);
      bool has = all(lessThan(next, ivec2(push.size)));
      int to = has ? next.y * int(push.size.x) + next.x : int(n);
      vec2 beside = there(rotation, place, view_rotation, view_place, next);
      float depth = FETCH(surface, int(n)).w, step_of_depth = FETCH(surface, to).w - depth;
      bool counts = has && here.y > 0.0 && beside.y > 0.0 && abs(step_of_depth) <= kJump * depth;
      float a = beside.x - here.x, b = FETCH1(brightness, to) - FETCH1(brightness, int(n));
      sums += counts ? vec4(a * b, b * b, a * a, 1.0) : vec4(0.0);
    }
  }
  sums = workgroup_sum(sums);
  if (gl_LocalInvocationIndex != 0u) return;
  float count = max(sums.w, 1.0);
  STORE(agreement, 0, vec4(sums.x * inversesqrt(max(sums.y * sums.z, 1e-20)), sqrt(sums.yz / count), sums.w));
}
