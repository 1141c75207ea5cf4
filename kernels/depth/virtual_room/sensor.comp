// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/normal_pair.glsl"
#include "image/random.glsl"
#include "camera/jump.glsl"
#include "camera/noise.glsl"

// Model of a structured-light depth sensor: noise that grows with depth (Nguyen et al. 2012), steps of disparity, and no depth at
// edges and on dark surfaces. One pixel an invocation.
//   z' = B / step(B / z + noise(z) B / z² g),  B = focal length · base, steps of kDisparityStep, g normal
PLANE_IN(0, layers);  // w: depth, meters
PLANE_IN(1, truth);   // rgb: reflectance
SCALAR_OUT(2, depth); // 0: none
layout(push_constant) uniform Push {
  uvec2 size;
  float amount;  // of the noise; 0: the depth as it is
  float max_depth;
  uint seed, frame;
} push;

const float kBase = 0.075, kFocal = 580.0;     // meters, pixels of the sensor
const float kDisparityStep = 0.125;            // pixels
const float kEdgeLoss = 0.6;                   // share of pixels beside an edge that have no depth
const float kDark = 0.05;                      // reflectance below which pixels have no depth more and more often

float depth_at(ivec2 pixel) {
  ivec2 p = clamp(pixel, ivec2(0), ivec2(push.size) - 1);
  return FETCH(layers, p.y * int(push.size.x) + p.x).w;
}

void main() {
  uint line = line_index();
  ivec2 pixel = ivec2(line % push.size.x, line / push.size.x);
  if (pixel.y >= int(push.size.y)) return;
  float z = depth_at(pixel), result = z;
  uvec3 words = pcg3d(uvec3(line, push.frame, push.seed));
  vec2 chance = vec2(pcg3d(words).xy >> 8u) / 16777216.0;
  vec4 beside = abs(vec4(depth_at(pixel - ivec2(1, 0)), depth_at(pixel + ivec2(1, 0)), depth_at(pixel - ivec2(0, 1)), depth_at(pixel + ivec2(0, 1))) - z);
  bool edge = any(greaterThan(beside, vec4(kJump * z)));
  float dark = 1.0 - dot(FETCH(truth, int(line)).rgb, vec3(1.0 / 3.0)) / kDark;
  float from = kFocal * kBase / z, noise = push.amount * noise_at(z) * from / z * normal_pair(words.xy).x;
  float disparity = round((from + noise) / kDisparityStep) * kDisparityStep;
  bool lost = (edge && chance.x < kEdgeLoss) || chance.y < dark || disparity <= 0.0;
  if (push.amount > 0.0) result = lost ? 0.0 : kFocal * kBase / max(disparity, kDisparityStep);
  STORE(depth, line, result <= push.max_depth ? result : 0.0);
}
