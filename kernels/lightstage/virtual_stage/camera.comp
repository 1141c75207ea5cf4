// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/normal_pair.glsl"
#include "image/random.glsl"

// Model of a camera: rows shifted sideways, gain, and sensor noise.
//   moved(x, y) = light(x - shift(y), y), linear between pixels;  shift(y) = sway (1 - y / (height - 1))
//   out = v + sigma g,  v = gain · moved,  sigma² = noise² (0.9 v + 0.1),  g normal
PLANE_IN(0, light);
PLANE_OUT(1, picture);
layout(push_constant) uniform Push {
  uint width, height;
  float sway;  // of the top row, pixels to the right
  float gain;
  float noise;  // standard deviation at white
  uint seed, frame;
} push;

void main() {
  uint i = line_index();
  if (i >= push.width * push.height) return;
  uint x = i % push.width, y = i / push.width;
  float shift = push.sway * (1.0 - float(y) / float(max(push.height, 2u) - 1u));
  float from = clamp(float(x) - shift, 0.0, float(push.width - 1u));
  float left = floor(from), f = from - left;
  int row = int(y * push.width), last = int(push.width) - 1, l = int(left);
  vec3 v = mix(FETCH(light, row + l).rgb, FETCH(light, row + min(l + 1, last)).rgb, f) * push.gain;
  uvec3 words = pcg3d(uvec3(i, push.frame, push.seed)), more = pcg3d(words);
  vec3 g = vec3(normal_pair(words.xy), normal_pair(more.xy).x);
  vec3 sigma = push.noise * sqrt(0.9 * max(v, 0.0) + 0.1);
  STORE(picture, i, vec4(push.noise > 0.0 ? v + sigma * g : v, 1.0));
}
