// SPDX-License-Identifier: LGPL-2.1-or-later
// The guide: planes of local cues. A guide cell is (m, c0, c1, u): with i = ln(I + 0.002) and k = ln(I + 0.01), m = mean_c i,
// u = max_c i - m, c0 = √3/2 (k_R - k_G), c1 = (k_R + k_G) / 2 - k_B: axes of equal scale, so that a distance of chroma does not
// depend on the order of channels. Level 0 is one vec4 per pixel; levels above hold means of 2 x 2 cells (at an odd border the
// last row or column counts twice). Level 2, the cells, has a second vec4 per cell: the mean activity |dm| and |dc| of the pixels'
// steps to their four neighbors, each step half with either end. In colored light u, c0 and c1 are of the frame in white light.
const float kIntensityFloor = 2e-3;
const float kChromaFloor = 1e-2;
const float kMaxLight = 1e4;
#define CELL_STRIDE 2

// Statistics of a frame, two vec4: mean log intensity, sigma4 of the prior's cues, -, -; and sigma0 … sigma3 of the prior's cues.
#define STATISTICS_MEAN 0
#define STATISTICS_SIGMAS 1
#define STATISTICS_SIZE 2

// Input of the method: NaN and negative values count as 0, +Inf (a broken sample) as 1.
vec3 sanitize(vec3 rgb) {
  return mix(vec3(0.0), mix(min(rgb, kMaxLight), vec3(1.0), isinf(rgb)), greaterThan(rgb, vec3(0.0)));
}

float mean_log(vec3 rgb) {
  vec3 light = rgb + kIntensityFloor;
  return log(light.r * light.g * light.b) / 3.0;
}

// m is that of the frame; with colored light, rgb is the color in white light.
vec4 guide_of(vec3 rgb, float m) {
  vec3 light = rgb + kIntensityFloor, color = rgb + kChromaFloor;
  return vec4(m, 0.8660254 * log(color.r / color.g), log(sqrt(color.r * color.g) / color.b),
              log(max(max(light.r, light.g), light.b)) - m);
}

// ln of the channels less their mean, of a color (c0, c1).
vec3 log_channels(vec2 color) {
  return vec3(color.y / 3.0 + 0.57735027 * color.x, color.y / 3.0 - 0.57735027 * color.x, color.y / -1.5);
}

// ln of the mean channel less the mean of the channels' logs, of a color (c0, c1).
float mean_channel(vec2 color) {
  vec3 channels = exp(log_channels(color));
  return log((channels.r + channels.g + channels.b) / 3.0);
}
