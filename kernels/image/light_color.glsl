// SPDX-License-Identifier: LGPL-2.1-or-later
// The color of light: ln light of channel c is (1 + k d_c) s, s = ln S the shading and d = (1/2, 0, -1/2) for R, G, B. Mixtures of two
// lights of different color temperature are near that line. k, the slope, is one number a scene; 0 is gray light.
//
// Role::slope, one vec4: k; ln S at which light is white; how sure k is, 0...1; the decomposer's own.
#define SLOPE_K 0
#define SLOPE_WHITE 1
#define SLOPE_CONFIDENCE 2
#define SLOPE_DONE 3  // what was done in the frame, LIGHT_... of light.glsl

// Factor of red from white light to light that is `above` brighter, ln. Bounded, so that its square and inverse are finite.
float light_red(float k, float above) { return exp(clamp(0.5 * k * above, -20.0, 20.0)); }

// The same of all channels.
vec3 light_color(float k, float above) {
  float red = light_red(k, above);
  return vec3(red, 1.0, 1.0 / red);
}

// rgb / (shading light_color(k, above)), with one division.
vec3 reflectance_in(vec3 rgb, float shading, float k, float above) {
  float red = light_red(k, above), inverse = 1.0 / (shading * red);
  return rgb * (inverse * vec3(1.0, red, red * red));
}

// Light that has this shading.
vec3 colored_light(vec4 slope, float shading) {
  return shading > 0.0 ? shading * light_color(slope[SLOPE_K], log(shading) - slope[SLOPE_WHITE]) : vec3(0.0);
}
