// SPDX-License-Identifier: LGPL-2.1-or-later
// A 3 x 3 convolution with zero padding, bias and activation. An invocation computes ROWS pixels, one below the other,
// of one block of channels; a step reads one column of pixels of one input block, so that each input is read once for
// all rows.
//
// Weights: [block] of bias, then [block][input block][column][row][input channel], each a vec4 of the four channels of
// the result.
#define ENTERING (STRIDE * (ROWS - 1) + 3)  // rows of the input that ROWS of the result see

#if STRIDE == 1  // plan.cpp fuses nothing into the others
layout(constant_id = 2) const bool kUpsampled = false;  // the first source, as it is read
layout(constant_id = 3) const bool kSecond = false;     // there are two sources, one channel behind the other
#endif
PLANE_IN(0, first);
PLANE_IN(1, second);
PLANE_IN(2, weights);
PLANE_OUT(3, result);
layout(push_constant) uniform Push {
  ivec2 size;    // of the result
  ivec2 source;  // of the image that is convolved
  int first_blocks, second_blocks, blocks;
  float slope;
} push;

// Adds the contribution of a column for the weights of one row. The rows are unrolled by hand: a compiler that keeps
// the loop stores the arrays in memory, at ten times the cost.
#define ADD_ROW(row)                                                                                                     \
  {                                                                                                                      \
    vec4 r = FETCH(weights, weight), g = FETCH(weights, weight + 1), b = FETCH(weights, weight + 2),                     \
         a = FETCH(weights, weight + 3);                                                                                 \
    weight += 4;                                                                                                         \
    for (int line = 0; line < ROWS; ++line) {                                                                            \
      vec4 v = column[STRIDE * line + row];                                                                              \
      sums[line] += v.r * r + v.g * g + v.b * b + v.a * a;                                                               \
    }                                                                                                                    \
  }
#define ADD_COLUMN ADD_ROW(0) ADD_ROW(1) ADD_ROW(2)

#define READ_COLUMN(image, across, top, start)                                                                           \
  {                                                                                                                      \
    bool inside = (across) >= 0 && (across) < push.source.x;                                                             \
    for (int entry = 0; entry < ENTERING; ++entry) {                                                                     \
      int y = (top) + entry;                                                                                             \
      column[entry] = FETCH(image, inside && y >= 0 && y < push.source.y ? (start) + y * push.source.x + (across) : 0);  \
    }                                                                                                                    \
  }

// A column of the first source at twice its size. Even rows are a quarter below the middle between two of its pixels,
// odd ones a quarter above.
#define READ_UPSAMPLED(across, top, start)                                                                               \
  {                                                                                                                      \
    ivec2 small = push.source / 2;                                                                                       \
    float inside = (across) >= 0 && (across) < push.source.x ? 1.0 : 0.0;                                                \
    int low = clamp(((across) + 1) / 2 - 1, 0, small.x - 1), high = clamp(((across) + 1) / 2, 0, small.x - 1);           \
    float share = ((across) & 1) == 0 ? 0.75 : 0.25;                                                                     \
    vec4 above = vec4(0.0);                                                                                              \
    for (int entry = 0; entry <= ENTERING / 2; ++entry) {                                                                \
      int at = (start) + clamp(((top) + 1) / 2 - 1 + entry, 0, small.y - 1) * small.x;                                   \
      vec4 here = inside * mix(FETCH(first, at + low), FETCH(first, at + high), share);                                  \
      if (entry > 0) {                                                                                                   \
        int y = (top) + 2 * entry - 2;                                                                                   \
        column[2 * entry - 2] = y >= 0 && y < push.source.y ? mix(above, here, 0.25) : vec4(0.0);                        \
        column[2 * entry - 1] = y + 1 < push.source.y ? mix(above, here, 0.75) : vec4(0.0);                              \
      }                                                                                                                  \
      above = here;                                                                                                      \
    }                                                                                                                    \
  }

void main() {
  int item = int(line_index()), strips = (push.size.y + ROWS - 1) / ROWS;
  int x = item % push.size.x, strip = (item / push.size.x) % strips, block = item / (push.size.x * strips);
  if (block >= push.blocks) return;
  vec4 sums[ROWS], column[ENTERING], bias = FETCH(weights, block);
  for (int y = 0; y < ROWS; ++y) sums[y] = bias;
  int top = STRIDE * ROWS * strip - 1, left = STRIDE * x - 1;
  int weight = push.blocks + 36 * block * (push.first_blocks + push.second_blocks);
  int area = push.source.x * push.source.y;
  for (int i = 0; i < push.first_blocks; ++i)
    for (int dx = 0; dx < 3; ++dx) {
#if STRIDE == 1
      if (kUpsampled) {
        READ_UPSAMPLED(left + dx, top, 1 + i * (area / 4))
      } else
#endif
      {
        READ_COLUMN(first, left + dx, top, 1 + i * area)
      }
      ADD_COLUMN
    }
#if STRIDE == 1
  if (kSecond)
    for (int i = 0; i < push.second_blocks; ++i)
      for (int dx = 0; dx < 3; ++dx) {
        READ_COLUMN(second, left + dx, top, 1 + i * area)
        ADD_COLUMN
      }
#endif
  int at = 1 + (block * push.size.y + strip * ROWS) * push.size.x + x;
  for (int y = 0; y < ROWS; ++y)
    if (strip * ROWS + y < push.size.y) STORE(result, at + y * push.size.x, activated(sums[y], push.slope));
}
