// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "plane.glsl"

// Puts a picture on a plane of the reflectance: R' = R + w (white C − A R), C its color times its alpha A, and
//
//   w = opacity · matte · (1 − hidden) · Π clamp(½ + distance to an edge in pixels, 0, 1)
//
// The picture is filtered over the area that a pixel covers: up to kMaxTaps samples along its longer axis, each from the two
// nearest levels of the pyramid.
layout(constant_id = 1) const bool MATTE = false;   // multiply by the mask layer
layout(constant_id = 2) const bool HIDDEN = false;  // hide it behind what stands before the plane

PLANE_IN(0, intrinsic);
PLANE_IN(1, mask);
PLANE_IN(2, pyramid);  // levels of the picture, each half as wide and high as the one before, rounded up
SCALAR_IN(3, hidden);
PLANE_OUT(4, edited);
layout(push_constant) uniform Push {
  vec4 to_plane[3];  // rows of the homography from pixels to the unit square, with depth > 0 on the plane
  uvec2 size;
  uvec2 picture;  // pixels of level 0
  uvec2 cells;
  uint levels;
  float white;
  float opacity;
  uint first_row;
} push;

const float kMaxTaps = 8.0;

vec4 texel(int n) { return FETCH(pyramid, n); }
float cell(int n) { return FETCH1(hidden, n); }

vec4 level_at(vec2 place, uint level) {
  uvec2 size = push.picture;
  int first = 0;
  for (uint k = 0u; k < level; ++k) {
    first += int(size.x * size.y);
    size = (size + 1u) / 2u;
  }
  Between b = between(place * vec2(size), size);
  int width = int(size.x);
#define LEVEL_TEXEL(index) texel(first + (index))
  return BILINEAR(LEVEL_TEXEL, b, width);
}

vec4 sampled(vec2 place, float level) {
  float last = float(push.levels - 1u), low = min(floor(level), last);
  vec4 fine = level_at(place, uint(low));
  return low < last && level > low ? mix(fine, level_at(place, uint(low) + 1u), level - low) : fine;
}

void main() {
  uvec2 at = uvec2(gl_GlobalInvocationID.x, push.first_row + gl_GlobalInvocationID.y * kRows);
  if (at.x >= push.size.x) return;
  uint last = min(at.y + kRows, push.size.y);
  for (uint y = at.y; y < last; ++y) {
    int n = int(y * push.size.x + at.x);
    vec4 layers = finite(FETCH(intrinsic, n));
    float depth;
    vec2 place = mapped(push.to_plane, vec2(at.x, y) + 0.5, depth);
    if (!(depth > 0.0)) {
      STORE(edited, BY_ROWS(n), layers);
      continue;
    }
    // How the place changes from a pixel to the next, along x and along y.
    vec2 along_x = (vec2(push.to_plane[0].x, push.to_plane[1].x) - place * push.to_plane[2].x) / depth;
    vec2 along_y = (vec2(push.to_plane[0].y, push.to_plane[1].y) - place * push.to_plane[2].y) / depth;
    vec2 slope = max(sqrt(along_x * along_x + along_y * along_y), vec2(1e-12));
    vec2 inside = clamp(0.5 + place / slope, vec2(0.0), vec2(1.0)) * clamp(0.5 + (1.0 - place) / slope, vec2(0.0), vec2(1.0));
    float w = push.opacity * inside.x * inside.y;
    if (!(w > 0.0)) {
      STORE(edited, BY_ROWS(n), layers);
      continue;
    }
    vec2 across = along_x * vec2(push.picture), down = along_y * vec2(push.picture);
    float a = length(across), b = length(down);
    vec2 axis = a > b ? along_x : along_y;
    float taps = clamp(ceil(max(a, b) / max(min(a, b), 1.0)), 1.0, kMaxTaps);
    float level = max(log2(max(max(a, b) / taps, 1e-6)), 0.0);
    vec4 color = vec4(0.0);
    for (float k = 0.5; k < taps; ++k) color += sampled(place + axis * (k / taps - 0.5), level);
    color /= taps;
    if (MATTE) w *= min(finite(FETCH(mask, n)).x, 1.0);
    if (HIDDEN) {
      Between c = between(place * vec2(push.cells), push.cells);
      int width = int(push.cells.x);
      w *= 1.0 - BILINEAR(cell, c, width);
    }
    vec3 changed = layers.rgb + w * (push.white * color.rgb - color.a * layers.rgb);
    STORE(edited, BY_ROWS(n), vec4(clamp(changed, vec3(0.0), vec3(kLargest)), layers.w));
  }
}
