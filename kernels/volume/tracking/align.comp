// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "volume/camera.glsl"
#include "volume/noise.glsl"
#include "align.glsl"

// Normal equations of the camera's motion that brings what it sees onto a view of the volume: projective association (Rusinkiewicz and
// Levoy 2001), distances to planes, and differences of ln brightness. Motion is a turn about the camera's place and a shift, in the
// world's axes. kRows pixels of a column an invocation.
PLANE_IN(0, surface);    // of the frame at this level
PLANE_IN(1, pose);       // of the frame, an estimate
PLANE_IN(2, model);      // normal and depth of the view, at the same level
PLANE_IN(3, view_pose);
SCALAR_IN(4, brightness);  // ln, of the frame
SCALAR_IN(5, appearance);  // ln brightness of the view
PLANE_OUT(6, sums);        // kSums a workgroup
layout(push_constant) uniform Push {
  vec4 lens;  // of both at this level
  uvec2 size;
  float max_distance;  // meters, between points that belong together
  float min_cosine;    // of their normals
  float photometric;   // meters that a difference of 1 in ln brightness counts as; 0: not used
} push;

const uint kRows = 8u;
const float kJump = 0.03;    // of the depth, between neighbors of one surface
const float kTurned = 0.05;  // of brightness: differences beyond it lose weight

vec4 total[kSums];

void add(vec3 turn, vec3 shift, float r, float weight) {
  vec3 wt = weight * turn, ws = weight * shift;
  total[0] += vec4(wt.x * turn, wt.x * shift.x);
  total[1] += vec4(wt.x * shift.yz, wt.y * turn.yz);
  total[2] += vec4(wt.y * shift, wt.z * turn.z);
  total[3] += vec4(wt.z * shift, ws.x * shift.x);
  total[4] += vec4(ws.x * shift.yz, ws.y * shift.yz);
  total[5] += vec4(ws.z * shift.z, r * wt);
  total[6].xyz += r * ws;
}

void main() {
  for (uint k = 0u; k < kSums; ++k) total[k] = vec4(0.0);
  uint line = line_index(), columns = push.size.x, group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  uint x = line % columns, first = line / columns * kRows;
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1), view_rotation = FETCH(view_pose, 0), view_place = FETCH(view_pose, 1);
  for (uint y = first; y < min(first + kRows, push.size.y); ++y) {
    int from = int(y * columns + x);
    vec4 seen = FETCH(surface, from);
    if (!(seen.w > 0.0)) continue;
    total[7].z += 1.0;
    vec3 arm = turned(rotation, seen.w * ray_of(push.lens, vec2(x, y)));  // from the camera, in the world's axes
    vec3 in_view = to_camera(view_rotation, view_place, arm + place.xyz);
    if (!(in_view.z > 0.0)) continue;
    vec2 at = projected(push.lens, in_view);
    ivec2 pixel = ivec2(floor(at + 0.5));
    if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(push.size)))) continue;
    vec4 found = FETCH(model, pixel.y * int(push.size.x) + pixel.x);
    if (!(found.w > 0.0)) continue;
    vec3 apart = found.w * ray_of(push.lens, vec2(pixel)) - in_view;
    vec3 normal = turned(view_rotation, found.xyz);
    bool faces = dot(turned(rotation, seen.xyz), normal) > push.min_cosine;
    if (!(dot(apart, apart) < push.max_distance * push.max_distance) || !faces) {
      total[7].w += 1.0;
      continue;
    }
    total[7].y += 1.0;
    float weight = kNoise / noise_at(seen.w);
    float r = dot(found.xyz, apart);  // that motion is to remove
    weight *= weight;
    add(cross(arm, normal), normal, r, weight);
    total[6].w += weight * r * r;
    total[7].x += weight;
    if (!(push.photometric > 0.0)) continue;
    // Where the surface goes on around the pixel.
    if (any(lessThan(pixel, ivec2(1))) || any(greaterThanEqual(pixel, ivec2(push.size) - 1))) continue;
    int center = pixel.y * int(push.size.x) + pixel.x;
    ivec4 beside = center + ivec4(-1, 1, -int(push.size.x), int(push.size.x));
    vec4 depths, around;
    for (int n = 0; n < 4; ++n) {
      depths[n] = FETCH(model, beside[n]).w;
      around[n] = FETCH1(appearance, beside[n]);
    }
    if (any(greaterThan(abs(depths - found.w), vec4(kJump * found.w)))) continue;
    float here = FETCH1(brightness, from), there = FETCH1(appearance, center);
    vec2 slope = 0.5 * (around.yw - around.xz);
    // Of the view's brightness where the point falls, by the point in the view's axes.
    vec2 scaled = slope * push.lens.xy / in_view.z;
    vec3 by_point = turned(view_rotation, vec3(scaled, -dot(scaled, in_view.xy) / in_view.z));
    float difference = here - there - dot(slope, at - vec2(pixel));
    float sure = push.photometric * push.photometric * kTurned / max(abs(difference), kTurned);
    add(cross(arm, by_point), by_point, difference, sure);
  }
  for (uint k = 0u; k < kSums; ++k) {
    vec4 sum = workgroup_sum(total[k]);
    if (gl_LocalInvocationIndex == 0u) STORE(sums, group * kSums + k, sum);
  }
}
