// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "edit/edit.glsl"
#include "image/light_color.glsl"
#include "image/srgb.glsl"
#include "relight.glsl"

// Light of lamps is added to a share of the light that is there:
//
//   T = (1 - matte (1 - ambient)) S C(S) L + matte E        E = sum of lamps: those over the picture, and those in a scene
//
// T is given to the layers as S' = (1 - matte (1 - ambient)) S + matte mean E, and its color to L' = T / (S' C(S')).
layout(constant_id = 1) const bool COLOR = false;  // light has a color: write L'. Else all of it is white
// push.surface
const uint kFlat = 0u;    // faces the viewer, in the picture plane
const uint kSlopes = 1u;  // in the picture plane, with normals of slopes on a grid
const uint kMap = 2u;     // normals and depth of pixels; depth 0: in the picture plane

PLANE_IN(0, intrinsic);
PLANE_IN(1, mask);
PLANE_IN(2, surface);  // kSlopes: dh/dx, dh/dy; kMap: unit normal, depth in meters
PLANE_IN(3, lamps);    // relight.glsl
PLANE_IN(4, light);    // rgb, direct share of S
PLANE_IN(5, slope);
PLANE_IN(6, scene_light);  // scene_light.comp
PLANE_OUT(7, edited);
PLANE_OUT(8, lit);     // COLOR
SCALAR_OUT(9, kept);   // COLOR: share of S' that was in S
layout(push_constant) uniform Push {
  uvec2 size;
  uvec2 grid;   // of slopes
  uvec2 view;   // of the light of lamps in a scene; 0: there is none
  float cells;  // grid cells a pixel
  float relief;
  float scale;        // 1 / width of the frame, or 1 / focal length
  float plane_depth;  // meters
  float ambient;
  float marker;  // radius of markers, pixels; 0: none
  int count;     // of lamps over the picture, which are the first ones of the table
  int marks;     // of all lamps
  uint surface;
  uint has_mask, has_light, has_slope;  // what is not there is 1, 1 and white
  uint first_row;
} push;

#include "lamp_light.glsl"
#define SEEN(index) FETCH(scene_light, index)
#include "camera/between_pixels.glsl"

vec2 slope_at(uvec2 at) {
  vec2 place = clamp((vec2(at) + 0.5) * push.cells - 0.5, vec2(0.0), vec2(push.grid - 1u));
  ivec2 low = ivec2(place), high = min(low + 1, ivec2(push.grid) - 1);
  vec2 part = place - vec2(low);
  int above = low.y * int(push.grid.x), below = high.y * int(push.grid.x);
  return mix(mix(FETCH(surface, above + low.x).xy, FETCH(surface, above + high.x).xy, part.x),
             mix(FETCH(surface, below + low.x).xy, FETCH(surface, below + high.x).xy, part.x), part.y);
}

// Light of the lamps over the picture on a surface.
vec3 light_on(vec3 place, vec3 normal) {
  vec3 sum = vec3(0.0);
  for (int k = 0; k < push.count; ++k) sum += light_of(k, place, normal);
  return min(sum, vec3(kLargest));
}

// The marker that covers a pixel: reflectance; below 0: none.
vec3 marker_at(vec2 at) {
  vec3 color = vec3(-1.0);
  for (int k = 0; k < push.marks; ++k) {
    vec4 mark = FETCH(lamps, kLampRows * k + kMark);
    float off = distance(at, mark.xy) / push.marker;
    if (off > 1.0) continue;
    uint code = uint(mark.w);
    color = off > 0.75 ? vec3(0.0) : to_linear(vec3(uvec3(code >> 16, code >> 8, code) & 255u) / 255.0);
  }
  return color;
}

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  bool has_light = COLOR && push.has_light == 1u, has_slope = COLOR && push.has_slope == 1u;
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec4 layers = finite(FETCH(intrinsic, n));
    vec4 before = has_light ? finite(FETCH(light, n)) : vec4(1.0);
    float matte = push.has_mask == 1u ? min(finite(FETCH(mask, n)).x, 1.0) : 1.0;
    float keep = 1.0 - matte * (1.0 - push.ambient);

    vec3 normal = vec3(0.0, 0.0, 1.0);
    float scale = push.scale, above = 0.0;
    if (push.surface == kSlopes) normal = normalize(vec3(-push.relief * slope_at(uvec2(at.x, y)), 1.0));
    if (push.surface == kMap) {
      vec4 seen = FETCH(surface, n);
      normal = seen.xyz;
      if (seen.w > 0.0) {
        scale *= seen.w;
        above = push.plane_depth - seen.w;
      }
    }
    vec2 off = vec2(at.x, y) + 0.5 - 0.5 * vec2(push.size);
    vec3 of_lamps = light_on(vec3(off * scale, above), normal);
    if (push.view.x > 0u) of_lamps = min(of_lamps + between_pixels(uvec2(at.x, y), push.size, push.view, 1u), vec3(kLargest));
    vec3 added = matte * of_lamps;
    vec3 total = keep * (has_slope ? colored_light(FETCH(slope, 0), layers.w) : layers.www) * before.rgb + added;
    float own = keep * layers.w, gray = mean3(added), now = min(own + gray, kLargest);
    bool same = keep == 1.0 && gray == 0.0;
    if (push.marker > 0.0) {
      vec3 marker = marker_at(vec2(at.x, y) + 0.5);
      if (marker.r >= 0.0) {
        layers.rgb = marker;
        total = vec3(1.0);
        own = 0.0, gray = 1.0, now = 1.0;
        same = false;
      }
    }
    STORE(edited, BY_ROWS(n), vec4(layers.rgb, now));
    if (COLOR) {
      vec4 after = before;
      if (!same && now > 0.0) {
        vec3 gray_light = has_slope ? colored_light(FETCH(slope, 0), now) : vec3(now);
        after = vec4(min(total / max(gray_light, vec3(1e-30)), vec3(kLargest)), min((own * before.w + gray) / now, 1.0));
      }
      STORE(lit, BY_ROWS(n), after);
      STORE(kept, BY_ROWS(n), now > 0.0 ? min(own / now, 1.0) : 1.0);
    }
  }
}
