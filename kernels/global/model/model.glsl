// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsic's model (docs/reference/methods/globalintrinsic.md): I = R S tau, where S tau = T0 1 + E is white direct light and
// colored indirect light; in colored light (light.glsl), of a frame that is divided by the color of light of its brightness. Colors
// are compared as log chroma, coordinates of ln RGB along (1, -1, 0) / √2 and (1, 1, -2) / √6; the tint t of light is
// the log chroma of T0 1 + E, and tau = exp(Aᵀ t) has geometric mean 1.
//
// The color of light is estimated on a grid of points, each the mean of factor x factor pixels; light from the surfaces in view on
// a grid of half as many.
#include "intrinsic/light_color/white_light.glsl"

const float kLogFloor = 3e-3;  // black becomes neutral
const int kSlots = 16;         // base colors
const int kBins = 64;          // of chroma, along one axis
const float kBinWidth = 0.08;
const int kBinCount = kBins * kBins;
const int kCandidates = 16;  // for the amount of indirect light

// The scene's buffer.
#define SCENE_AMOUNT 0
#define AMOUNT_KAPPA 0
#define AMOUNT_CONFIDENCE 1
#define AMOUNT_WEIGHT 2  // mean of the points
#define AMOUNT_COLORS 3  // base colors in use
#define SCENE_TINT 1
#define TINT_RMS 0       // if all light were indirect
#define TINT_RESIDUAL 1  // share of the residual that counts
#define TINT_USABLE 2    // share of colors to measure by, 0…1
#define TINT_SPREAD 3    // of chroma
#define SCENE_TIME 2
#define TIME_CUT 0     // 1 at a start or cut
#define TIME_FRAMES 1  // with color since then
#define TIME_SHARE 2   // of this frame
#define TIME_CHANGE 3  // of this frame
#define SCENE_WHITE 3   // log chroma of the lamps, as far as removed; confidence of the color of gathered light
#define SCENE_COSTS 4   // four vec4: of the candidates
#define SCENE_COLORS 8  // log chroma, 1 if the slot has a color, share of the frame
#define COLOR_USED 2
#define SCENE_MEMORY 24  // of base colors' slots: usual place, 1 if a color has it, frames since that had a mode
#define SCENE_SIZE 40

float mean3(vec3 v) { return (v.r + v.g + v.b) * (1.0 / 3.0); }

vec2 chroma_of(vec3 color) {
  vec3 l = log(color + kLogFloor);
  return vec2(0.70710678 * (l.r - l.g), 0.40824829 * (l.r + l.g - 2.0 * l.b));
}

vec3 color_of(vec2 chroma) {
  float u = 0.70710678 * chroma.x, v = 0.40824829 * chroma.y;
  return exp(vec3(v + u, v - u, -2.0 * v));
}

// Light of this mean, of which `indirect` (at most all) is indirect; and that share.
vec3 light_of(float shading, vec3 indirect) {
  float all = mean3(indirect), kept = all > shading ? shading / all : 1.0;
  return shading - kept * all + kept * indirect;
}
// Light of a color with this confidence: gray at 0.
vec3 colored_by(float confidence, vec3 light) { return mix(vec3(mean3(light)), light, confidence); }
float fraction_of(float shading, vec3 indirect) { return min(1.0, mean3(indirect) / max(shading, 1e-6)); }

// Place of a chroma in a histogram, in bins (gray is at a bin's center, not at the corner of four); and the bin of the nearest
// center.
vec2 place_of(vec2 chroma) { return chroma * (1.0 / kBinWidth) + 0.5 * float(kBins); }
int bin_of(vec2 chroma) {
  ivec2 at = ivec2(clamp(floor(place_of(chroma) + 0.5), 0.0, float(kBins - 1)));
  return at.y * kBins + at.x;
}
vec2 bin_center(int bin) { return kBinWidth * (vec2(bin & (kBins - 1), bin / kBins) - 0.5 * float(kBins)); }

// Interpolation from a grid that is coarser by `factor` and has `count` points: lower index and share of the next, for the center of
// point x.
vec2 between(int x, float factor, int count) {
  float at = clamp((float(x) + 0.5) / factor - 0.5, 0.0, float(count - 1));
  float low = min(floor(at), float(max(count - 2, 0)));
  return vec2(low, at - low);
}

// Estimate of shading before the solve: with the brightness of reflectance from the history; without history, with the white level
// as the largest channel of reflectance.
float shading_before(vec3 rgb, float memory) {
  vec3 light = rgb + kIntensityFloor;
  return exp(log(light.r * light.g * light.b) * (1.0 / 3.0) - memory);
}
float shading_guessed(vec3 rgb, float white_level) { return max(max(rgb.r, rgb.g), rgb.b) / white_level; }

#define SIZES            \
  ivec2 size;  /* of the frame */ \
  ivec2 grid;            \
  ivec2 coarse;          \
  int factor;  /* pixels along a point */

// Light that a surface of base color `label` receives at the center of a fine point, `factor` fine points to a coarse one;
// `received` has the coarse grid once for each base color.
#define RECEIVED(result, label, px, py, fine)                                              \
  {                                                                                      \
    vec2 u = between(px, fine, push.coarse.x), v = between(py, fine, push.coarse.y);       \
    ivec2 low = ivec2(u.x, v.x), high = min(low + 1, push.coarse - 1);                   \
    int base = (label) * push.coarse.x * push.coarse.y;                                  \
    int top = base + low.y * push.coarse.x, bottom = base + high.y * push.coarse.x;      \
    vec3 upper = mix(FETCH(received, top + low.x).rgb, FETCH(received, top + high.x).rgb, u.y); \
    vec3 lower = mix(FETCH(received, bottom + low.x).rgb, FETCH(received, bottom + high.x).rgb, u.y); \
    result = mix(upper, lower, v.y);                                                     \
  }

// The tint of the light at a pixel, between the points of the grid.
#define TINT_AT(result, tints, at)                                                                             \
  {                                                                                                            \
    vec2 tint_u = between((at).x, float(push.factor), push.grid.x);                                            \
    vec2 tint_v = between((at).y, float(push.factor), push.grid.y);                                            \
    ivec2 tint_low = ivec2(tint_u.x, tint_v.x), tint_high = min(tint_low + 1, push.grid - 1);                  \
    int tint_top = tint_low.y * push.grid.x, tint_bottom = tint_high.y * push.grid.x;                          \
    result = mix(mix(FETCH(tints, tint_top + tint_low.x), FETCH(tints, tint_top + tint_high.x), tint_u.y),     \
                 mix(FETCH(tints, tint_bottom + tint_low.x), FETCH(tints, tint_bottom + tint_high.x), tint_u.y), \
                 tint_v.y).xy;                                                                                 \
  }
