// SPDX-License-Identifier: LGPL-2.1-or-later
#version 450
#extension GL_GOOGLE_include_directive : require
#include "gpu/common.glsl"
#include "image/pack4.glsl"
#include "intrinsic/guide/guide.glsl"

// The input of PriorNetwork, as network::Network has it, from the guide: its mean over the 2^level x 2^level pixels of a network
// pixel. Beyond the picture its last column and row are repeated. One pixel an invocation.
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

// The place on level 2 of part k of the network pixel at `at`: of the ones on the way down, the last counts twice at an odd border.
int place(int at, int k, int size2) {
  for (int shift = push.level - 3; shift >= 0; --shift)
    at = min(2 * at + ((k >> shift) & 1), ((size2 - 1) >> shift));
  return at;
}

// The guide at a network pixel.
vec4 mean_guide(ivec2 at) {
  if (push.level == 0) return FETCH(level0, at.y * push.size.x + at.x);
  ivec2 size1 = (push.size + 1) / 2, size2 = (size1 + 1) / 2;
  if (push.level == 1) return FETCH(level1, at.y * size1.x + at.x);
  vec4 sum = vec4(0.0);
  int count = 1 << (push.level - 2);
  for (int j = 0; j < count; ++j) {
    int row = place(at.y, j, size2.y) * size2.x;
    for (int i = 0; i < count; ++i) sum += FETCH(cells, CELL_STRIDE * (row + place(at.x, i, size2.x)));
  }
  return sum / float(count * count);
}

void main() {
  ivec2 position = ivec2(grid_position(uint(push.padded.x)));
  if (position.y >= push.padded.y) return;
  vec4 guide = mean_guide(min(position, push.network - 1)), frame = FETCH(statistics, STATISTICS_MEAN);
  vec4 first = vec4(0.7 * (guide.x - frame.x), 2.0 * guide.yz, 2.0 * guide.w - 0.7);
  vec4 second = vec4(clamp(0.5 * (guide.x + 4.0), -1.0, 2.0), frame.y, 0.0, 0.0);
  int area = push.padded.x * push.padded.y, to = 1 + position.y * push.padded.x + position.x;
  STORE(result, to, clamp(first, -kLargestInput, kLargestInput));
  STORE(result, to + area, second);
}
