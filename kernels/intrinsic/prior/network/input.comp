// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "image/srgb.glsl"
#include "intrinsic/guide/guide.glsl"

// The input of PriorNetwork, as network::Network has it: six channels of the guide or, with kImage, the picture in white light, sRGB
// 0 ... 1. Beyond the picture its last column and row are repeated. One pixel an invocation.
layout(constant_id = 1) const bool kImage = false;
PLANE_IN(0, level0);
PLANE_IN(1, level1);
PLANE_IN(2, cells);
PLANE_IN(3, statistics);
PLANE_OUT(4, result);
layout(push_constant) uniform Push {
  ivec2 size;     // of the frame
  ivec2 network;  // of the network's picture
  ivec2 padded;   // of its input
  int level;
} push;

const float kLargestInput = 8.0;

#include "picture.glsl"

void main() {
  ivec2 position = ivec2(grid_position(uint(push.padded.x)));
  if (position.y >= push.padded.y) return;
  vec4 guide = mean_guide(min(position, push.network - 1));
  int area = push.padded.x * push.padded.y, to = 1 + position.y * push.padded.x + position.x;
  if (kImage) {
    STORE(result, to, vec4(to_srgb(exp(guide.x + log_channels(guide.yz)) - kIntensityFloor), 0.0));
    return;
  }
  vec4 frame = FETCH(statistics, STATISTICS_MEAN);
  vec4 first = vec4(0.7 * (guide.x - frame.x), 2.0 * guide.yz, 2.0 * guide.w - 0.7);
  vec4 second = vec4(clamp(0.5 * (guide.x + 4.0), -1.0, 2.0), frame.y, 0.0, 0.0);
  STORE(result, to, clamp(first, -kLargestInput, kLargestInput));
  STORE(result, to + area, second);
}
