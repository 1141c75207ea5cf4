// SPDX-License-Identifier: LGPL-2.1-or-later
// Shared by the kernels of the key (key.hpp; tests/reference/edit/key.hpp has the equations).
#include "edit/edit.glsl"

const float kBrightest = 16.0;     // linear light and reflectance above count as this bright
const float kSaturated = 0.25;     // chroma / mean of a screen at least, and of what is compared with one
const float kFrontMin = -1.0;      // chroma of a foreground along the screen's, over that, at least
const float kFrontMax = 0.2;       // and at most
const float kAcrossMin = 0.15;     // its chroma across the screen's, from which on its part is measured by that

vec3 chroma(vec3 c) { return c - mean3(c); }

// How far c goes toward the chroma direction d (of length 1) beyond 60 degrees to its sides: for a green d, G - max(R, B) times
// sqrt(2/3). Linear in mixtures with a color of hue d.
float excess(vec3 c, vec3 d) {
  vec3 q = chroma(c);
  float along = dot(q, d);
  return along - length(q - along * d) * 0.57735027;
}

vec4 bounded(vec4 value) { return min(finite(value), vec4(kBrightest)); }

// From 0 to 1 as t goes from `low` to `high`.
float rising(float low, float high, float t) { return 1.0 - falling((t - low) / (high - low)); }

// How surely a pixel shows the screen, whose mean reflectance is `screen`: by chromaticity R / mean R, also by brightness, of which
// shadows that are left in R may take much. In the dark there is no chromaticity.
const float kDarkest = 1.4, kNoShadow = 0.7;  // |ln ratio| to the screen's reflectance
float sureness(vec3 seen, vec3 paint, vec3 screen, float tolerance) {
  float value = mean3(paint), of_screen = mean3(screen);
  if (!(value > kReflectanceFloor)) return 0.0;
  float apart = distance(paint / value, screen / of_screen);
  return falling((apart - tolerance) / (0.5 * tolerance + 1e-3)) * rising(kLightFloor, 4.0 * kLightFloor, mean3(seen)) *
         falling((abs(log(value / of_screen)) - kNoShadow) / (kDarkest - kNoShadow));
}

// The four cells around a pixel, and their parts.
struct Place {
  ivec4 cells;
  vec4 parts;
};
Place place_of(uvec2 at, uvec2 cells, float per_cell) {
  vec2 place = clamp((vec2(at) + 0.5) * per_cell - 0.5, vec2(0.0), vec2(cells - 1u));
  ivec2 first = ivec2(place), last = min(first + 1, ivec2(cells) - 1);
  vec2 part = place - vec2(first);
  int width = int(cells.x);
  return Place(ivec4(first.y * width + first.x, first.y * width + last.x, last.y * width + first.x, last.y * width + last.x),
               vec4((1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y, part.x * part.y));
}
#define AROUND(plane, p) \
  (p.parts.x * FETCH(plane, p.cells.x) + p.parts.y * FETCH(plane, p.cells.y) + p.parts.z * FETCH(plane, p.cells.z) + p.parts.w * FETCH(plane, p.cells.w))

// Opacity of light `seen` before a screen of light `back` (w: 0 if there is none) and beside a foreground of light `front`, of which
// w is how surely the pixel is within it; without one (0) the foreground may have any color up to 60 degrees from the screen's hue.
float opacity(vec3 seen, vec4 back, vec4 front) {
  vec3 q = chroma(back.rgb);
  float length_q = length(q);
  if (!(back.w > 0.0) || !(length_q > 0.25 * kSaturated * mean3(back.rgb)) || !(length_q > 1e-5)) return 1.0;
  vec3 d = q / length_q;
  float free = 1.0 - excess(seen, d) / length_q;
  if (!(front.w > 0.0)) return clamp(free, 0.0, 1.0);
  float own = clamp(excess(front.rgb, d) / length_q, 0.0, kFrontMax);
  // Chroma of both along d, and across it.
  vec3 of_seen = chroma(seen), of_front = chroma(front.rgb);
  float along = dot(of_seen, d) / length_q, front_along = dot(of_front, d) / length_q;
  vec3 across = of_seen / length_q - along * d, front_across = of_front / length_q - front_along * d;
  front_along = clamp(front_along, kFrontMin, kFrontMax);
  // The foreground's part of the light, by what is across; if that is little, by what is along.
  float width2 = dot(front_across, front_across);
  float part = clamp(dot(across, front_across) / max(width2, 1e-6), 0.0, 2.0);
  float mixed = mix((1.0 - along) / (1.0 - min(front_along, 0.0)), 1.0 - along + part * front_along, width2 / (width2 + kAcrossMin * kAcrossMin));
  return mix(clamp(mixed, 0.0, 1.0), clamp(free / (1.0 - own), 0.0, 1.0), rising(0.5, 1.0, front.w));
}
