// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "gpu/workgroup_sum.glsl"
#include "camera/camera.glsl"
#include "camera/jump.glsl"
#include "camera/noise.glsl"
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
  float photometric;   // meters that a difference of 1 in ln brightness counts as
} push;

layout(constant_id = 1) const bool kPhotometric = true;
const uint kRows = 8u;
const float kTurned = 0.05;  // of brightness: differences beyond it lose weight

// Sums of kSums vec4, in registers.
vec4 s0 = vec4(0.0), s1 = s0, s2 = s0, s3 = s0, s4 = s0, s5 = s0, s6 = s0, s7 = s0;

void add(vec3 turn, vec3 shift, float r, float weight) {
  vec3 wt = weight * turn, ws = weight * shift;
  s0 += vec4(wt.x * turn, wt.x * shift.x);
  s1 += vec4(wt.x * shift.yz, wt.y * turn.yz);
  s2 += vec4(wt.y * shift, wt.z * turn.z);
  s3 += vec4(wt.z * shift, ws.x * shift.x);
  s4 += vec4(ws.x * shift.yz, ws.y * shift.yz);
  s5 += vec4(ws.z * shift.z, r * wt);
  s6.xyz += r * ws;
}

void keep(uint group, uint k, vec4 value) {
  vec4 sum = workgroup_sum(value);
  if (gl_LocalInvocationIndex == 0u) STORE(sums, group * kSums + k, sum);
}

void main() {
  uint line = line_index(), group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  int width = int(push.size.x), height = int(push.size.y);
  int x = int(line) % width, first = int(line) / width * int(kRows);
  vec4 rotation = FETCH(pose, 0), place = FETCH(pose, 1), view_rotation = FETCH(view_pose, 0), view_place = FETCH(view_pose, 1);
  // What does not match has no weight, in place of branches: lanes go through both sides of one.
  for (int y = first; y < min(first + int(kRows), height); ++y) {
    int from = y * width + x;
    vec4 seen = FETCH(surface, from);
    vec3 arm = turned(rotation, seen.w * ray_of(push.lens, vec2(x, y)));  // from the camera, in the world's axes
    vec3 in_view = to_camera(view_rotation, view_place, arm + place.xyz);
    bool ahead = seen.w > 0.0 && in_view.z > 0.0;
    float z = ahead ? in_view.z : 1.0;
    vec2 at = push.lens.xy * in_view.xy / z + push.lens.zw;
    ivec2 pixel = ivec2(clamp(floor(at + 0.5), vec2(-1.0), vec2(push.size)));
    bool inside = ahead && pixel.x >= 0 && pixel.y >= 0 && pixel.x < width && pixel.y < height;
    pixel = inside ? pixel : ivec2(0);
    int center = pixel.y * width + pixel.x;
    vec4 found = FETCH(model, center);
    vec3 apart = found.w * ray_of(push.lens, vec2(pixel)) - in_view, normal = turned(view_rotation, found.xyz);
    bool both = inside && found.w > 0.0;
    bool matches = both && dot(apart, apart) < push.max_distance * push.max_distance && dot(turned(rotation, seen.xyz), normal) > push.min_cosine;
    s7.yzw += vec3(matches, seen.w > 0.0, both && !matches);
    float certain = kNoise / noise_at(seen.w), weight = matches ? certain * certain : 0.0;
    float r = matches ? dot(found.xyz, apart) : 0.0;  // that motion is to remove
    add(cross(arm, normal), normal, r, weight);
    s6.w += weight * r * r;
    s7.x += weight;
    if (!kPhotometric) continue;
    // Between the four pixels around it, where the surface goes on.
    ivec2 low = ivec2(clamp(floor(at), vec2(0.0), vec2(push.size) - 2.0));
    vec2 share = at - vec2(low);
    int corner = low.y * width + low.x;
    ivec4 cell = inside && width > 1 && height > 1 ? corner + ivec4(0, 1, width, width + 1) : ivec4(center);
    vec4 b = vec4(FETCH1(appearance, cell.x), FETCH1(appearance, cell.y), FETCH1(appearance, cell.z), FETCH1(appearance, cell.w));
    vec4 steps = vec4(FETCH(model, cell.x).w, FETCH(model, cell.y).w, FETCH(model, cell.z).w, FETCH(model, cell.w).w) - found.w;
    bool goes_on = all(lessThanEqual(abs(steps), vec4(kJump * found.w)));
    vec2 slope = vec2(mix(b.y - b.x, b.w - b.z, share.y), mix(b.z - b.x, b.w - b.y, share.x));
    float there = mix(mix(b.x, b.y, share.x), mix(b.z, b.w, share.x), share.y);
    // Of the view's brightness where the point falls, by the point in the view's axes.
    vec2 scaled = slope * push.lens.xy / z;
    vec3 by_point = turned(view_rotation, vec3(scaled, -dot(scaled, in_view.xy) / z));
    float difference = matches ? FETCH1(brightness, from) - there : 0.0;
    float sure = matches && goes_on ? push.photometric * push.photometric * kTurned / max(abs(difference), kTurned) : 0.0;
    add(cross(arm, by_point), by_point, difference, sure);
  }
  keep(group, 0u, s0);
  keep(group, 1u, s1);
  keep(group, 2u, s2);
  keep(group, 3u, s3);
  keep(group, 4u, s4);
  keep(group, 5u, s5);
  keep(group, 6u, s6);
  keep(group, 7u, s7);
}
