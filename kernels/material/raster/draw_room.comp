// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "visible.glsl"
#include "camera/camera.glsl"
#include "camera/noise.glsl"

// As draw.comp, in a remembered scene: samples behind its surfaces do not count, and light is shaded by what stands in its way there.
PLANE_IN(3, placed);
PLANE_IN(4, LIT_TABLE);
PLANE_IN(5, room);
PLANE_IN(6, surface);  // SeenScene
PLANE_IN(7, reached);  // probes.comp
PLANE_OUT(8, picture);
#define LIT_TABLE LIT_TABLE
#include "environment/lit_sphere.glsl"
#include "visible_surface.glsl"
#include "room.glsl"

// The share of all light that reaches a surface of the object past the scene: the places around it, interpolated.
float reached_share(vec3 place, vec3 normal) {
  vec4 object = FETCH(room, kObject);
  vec3 on_grid = ((place - object.xyz) / (kProbeReach * object.w) * 0.5 + 0.5) * float(kProbes - 1);
  on_grid = clamp(on_grid, vec3(0.0), vec3(float(kProbes) - 1.001));
  ivec3 low = ivec3(on_grid);
  vec3 part = on_grid - vec3(low);
  vec4 lit[2] = vec4[](vec4(0.0), vec4(0.0));
  float total = 0.0;
  for (int n = 0; n < 8; ++n) {
    ivec3 off = ivec3(n & 1, n >> 1 & 1, n >> 2), at = low + off;
    vec3 w = mix(1.0 - part, part, vec3(off));
    int i = 2 * ((at.z * kProbes + at.y) * kProbes + at.x);
    vec4 first = FETCH(reached, i);
    float weight = first.x < 0.0 ? 0.0 : w.x * w.y * w.z;
    lit[0] += weight * first;
    lit[1] += weight * FETCH(reached, i + 1);
    total += weight;
  }
  if (total < 1e-3) return 1.0;
  float missing = 0.0, all = 0.0;
  for (int k = 0; k < beam_count(); ++k) {
    float light = light_of_beam(k, normal);
    all += light;
    missing += k < lamp_count() ? light * (1.0 - lit[k >> 2][k & 3] / total) : 0.0;
  }
  return 1.0 - missing / max(all, 1e-20);
}

vec3 shade(int who, vec2 at) {
  Surface s = surface_at(who, at);
  vec4 rotation = FETCH(room, kRotation);
  vec3 place = to_world(rotation, FETCH(room, kPlace), ray_of(push.lens, at) / s.depth);
  vec3 normal = turned(rotation, vec3(s.normal.x, -s.normal.yz));
  return lit_sphere(turned(FETCH(room, kToLit), s.normal), push.side) * reached_share(place, normal);
}

void main() {
  uvec2 at = pixel_of(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, push.size))) return;
  Seen seen[2];
  find_visible(at, seen);
  // The scene at the four pixels of the view around this one: 1 / distance beyond which the object is hidden there, 0 where nothing is
  // known.
  vec4 window = FETCH(room, kWindow);
  ivec2 view = ivec2(FETCH(room, kView).xy);
  vec2 on_view = clamp((vec2(at) + window.xy + 0.5) * window.zw - 0.5, vec2(0.0), vec2(view - 1));
  ivec2 low = ivec2(on_view), high = min(low + 1, view - 1);
  vec2 part = on_view - vec2(low);
  vec4 depth = vec4(FETCH(surface, low.y * view.x + low.x).w, FETCH(surface, low.y * view.x + high.x).w,
                    FETCH(surface, high.y * view.x + low.x).w, FETCH(surface, high.y * view.x + high.x).w);
  vec4 weight = vec4((1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y, part.x * part.y);
  vec4 limit;
  for (int i = 0; i < 4; ++i) limit[i] = depth[i] > 0.0 ? 1.0 / (depth[i] + noise_at(depth[i])) : 0.0;
  vec4 open[2] = vec4[](vec4(0.0), vec4(0.0));
  for (int i = 0; i < 4; ++i)
    for (int half_ = 0; half_ < 2; ++half_) open[half_] += weight[i] * vec4(greaterThanEqual(seen[half_].depth, vec4(limit[i])));

  vec4 sum = vec4(0.0);
  int who = largest(seen);
  while (who != kNone) {
    vec4 first = vec4(equal(seen[0].who, ivec4(who))), second = vec4(equal(seen[1].who, ivec4(who)));
    float count = dot(first + second, vec4(1.0)), visible = dot(first, open[0]) + dot(second, open[1]);
    vec2 middle = vec2(dot(first, kAcross[0]) + dot(second, kAcross[1]), dot(first, kDown[0]) + dot(second, kDown[1]));
    if (visible > 0.0) sum += visible * vec4(shade(who, vec2(at) + middle / count), 1.0);
    seen[0].who = mix(seen[0].who, ivec4(kNone), greaterThan(first, vec4(0.0)));
    seen[1].who = mix(seen[1].who, ivec4(kNone), greaterThan(second, vec4(0.0)));
    who = largest(seen);
  }
  STORE(picture, push.first + at.y * push.stride + at.x, sum / 8.0);
}
