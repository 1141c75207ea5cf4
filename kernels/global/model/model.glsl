// SPDX-License-Identifier: LGPL-2.1-or-later
// globalintrinsic's model (docs/reference/methods/globalintrinsic.md): I = R S tau, where S tau = T0 1 + E is white direct light and
// colored indirect light. Colors are compared as log chroma, coordinates of ln RGB along (1, -1, 0) / √2 and
// (1, 1, -2) / √6; the tint t of light is the log chroma of T0 1 + E, and tau = exp(Aᵀ t) has geometric mean 1.
//
// What light is, is decided on a grid of points, each the mean of factor x factor pixels; what arrives at a point from the
// surfaces in view on one of half as many.
#include "intrinsic/guide/guide.glsl"

const float kLogFloor = 3e-3;  // black becomes neutral
const int kSlots = 16;         // base colors
const int kBins = 64;          // of chroma, along one axis
const float kBinWidth = 0.08;
const int kBinCount = kBins * kBins;
const int kCandidates = 16;  // for the amount of indirect light

// The scene's buffer.
#define SCENE_AMOUNT 0  // kappa, its confidence, points' mean weight, base colors in use
#define SCENE_TINT 1    // rms tint where all light is indirect, share of the residual that is taken; what color there is to go by, 0…1, and
                        // how far chroma spreads
#define SCENE_TIME 2    // 1 where nothing is taken over from earlier frames, frames since then with color to go by, this one's
                        // share, change
#define SCENE_WHITE 3   // log chroma of the lamps, as far as it is taken out; how far the color of gathered light is believed
#define SCENE_COSTS 4   // four vec4: of the candidates
#define SCENE_COLORS 8  // log chroma, 1 where there is such a color, share of the frame
#define SCENE_MEMORY 24  // of base colors' slots: where it usually is, 1 where it is a color's, frames since that had a mode
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

// Light of this mean, of which `indirect` (at most all) is indirect; and the share that is.
vec3 light_of(float shading, vec3 indirect) {
  float all = mean3(indirect), kept = all > shading ? shading / all : 1.0;
  return shading - kept * all + kept * indirect;
}
// Light of a color that is believed that far: gray where the frame says nothing of it.
vec3 colored_by(float belief, vec3 light) { return mix(vec3(mean3(light)), light, belief); }
float fraction_of(float shading, vec3 indirect) { return min(1.0, mean3(indirect) / max(shading, 1e-6)); }

// Where a chroma lies in a histogram, in bins (gray is a bin's center, or it would be the corner of four); and the bin whose
// center is nearest.
vec2 place_of(vec2 chroma) { return chroma * (1.0 / kBinWidth) + 0.5 * float(kBins); }
int bin_of(vec2 chroma) {
  ivec2 at = ivec2(clamp(floor(place_of(chroma) + 0.5), 0.0, float(kBins - 1)));
  return at.y * kBins + at.x;
}
vec2 bin_center(int bin) { return kBinWidth * (vec2(bin & (kBins - 1), bin / kBins) - 0.5 * float(kBins)); }

// Between which points of a coarser grid of `count` the center of point x lies, `factor` of which make one: lower index and
// share of the next.
vec2 between(int x, float factor, int count) {
  float at = clamp((float(x) + 0.5) / factor - 0.5, 0.0, float(count - 1));
  float low = min(floor(at), float(max(count - 2, 0)));
  return vec2(low, at - low);
}

// What shading seems to be before the solve: what reflectance as bright as it was leaves of the pixel; and where nothing is
// known of it, what reflectance whose largest channel is the white level does.
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

// What a surface of base color `label` receives at the center of a fine point, `factor` fine points to a coarse one;
// `received` holds the coarse grid once for each base color.
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
