// SPDX-License-Identifier: LGPL-2.1-or-later
// The color of the scene's light (image/light_color.glsl): what is kept of it from frame to frame, and how its slope k is measured.
#include "image/light_color.glsl"

// Of the scene, vec4s:
#define LIGHT_NOW 0     // k; m at which the guide takes light as white; confidence of k, 0...1; 1 once a frame was seen
#define LIGHT_TARGET 1  // k as measured or given; its standard deviation; measurements in this scene, 0 if k is given; what was done
                        // in the frame, LIGHT_MEASURED ...
#define LIGHT_FRAME 2   // share of k that is used, by the frame's color; m of white light; what LIGHT_NOW takes at once, LIGHT_FOLLOW
                        // ...; change of the exposure (solve/scale.glsl) that LIGHT_NOW has not taken
#define LIGHT_VOTES 3   // for the candidates, averaged over measurements
#define LIGHT_SIZE 11

// What of the target LIGHT_NOW takes at once; the rest it follows slowly.
#define LIGHT_FOLLOW 0.0     // nothing
#define LIGHT_NEW_SLOPE 1.0  // k: it is given, or the first one that is measured in this scene
#define LIGHT_NEW_SCENE 2.0  // k and white light

// What was done in a frame.
#define LIGHT_MEASURED 0
#define LIGHT_REUSED 1
#define LIGHT_NO_COLOR 2     // nothing in the frame has color: k could not be seen, and would tint it
#define LIGHT_NO_CONTRAST 3  // all of the frame is alike: k has no effect

// The frame is seen as points, at most so many along its longer side, and at coarser levels: means of 2 x 2. A vec4 a point:
// m; b = ln R/B; g = ln sqrt(R B)/G; weight, low in the dark.
#define LIGHT_POINTS 176
#define LIGHT_LEVELS 4
// Every frame has wide points as well, of cells four times as wide, to detect a new scene.

// Steps between adjacent points are counted by level, by |dg|, by the size of dm, and by the slope db/dm, linear between bins.
#define STEP_TINTS 3
#define STEP_SIZES 10
#define STEP_SLOPES 43
#define STEP_CHANNELS (LIGHT_LEVELS * STEP_TINTS * STEP_SIZES)
#define STEP_COUNT (STEP_CHANNELS * STEP_SLOPES)
const float kStepUnit = 1.0 / 256.0;  // of a count
const float kSlopeWidth = 0.1;

// Kernels that measure, in the order of their workgroup counts.
#define MEASURE_POINTS 0
#define MEASURE_LEVELS 1
#define MEASURE_STEPS 2
#define MEASURE_FEATURES 3
#define MEASURE_VOTES 4
#define MEASURE_DECIDE 5
#define MEASURE_KERNELS 6

// The cloud: wide points counted by brightness below the brightest, and by b.
#define CLOUD_LEVELS 8
#define CLOUD_COLORS 20
#define CLOUD_COUNT (CLOUD_LEVELS * CLOUD_COLORS)

// Candidates for k: kSlopeWidth apart, around 0. A small network votes for them: two convolutions along the slopes, which treat
// all candidates alike, and a dense part.
#define CANDIDATES 29
#define NET_WIDTH 16
#define NET_TAPS 7
#define NET_DENSE 12
#define NET_HIDDEN (NET_WIDTH * STEP_SLOPES)
// Its weights, in this order:
#define NET_A 0
#define NET_A_BIAS (NET_A + NET_WIDTH * STEP_CHANNELS * NET_TAPS)
#define NET_B (NET_A_BIAS + NET_WIDTH)
#define NET_B_BIAS (NET_B + NET_WIDTH * NET_WIDTH * NET_TAPS)
#define NET_C (NET_B_BIAS + NET_WIDTH)
#define NET_C_BIAS (NET_C + NET_WIDTH)
#define NET_D (NET_C_BIAS + 1)
#define NET_D_BIAS (NET_D + NET_DENSE * NET_HIDDEN)
#define NET_CLOUD (NET_D_BIAS + NET_DENSE)
#define NET_CLOUD_BIAS (NET_CLOUD + NET_DENSE * CLOUD_COUNT)
#define NET_E (NET_CLOUD_BIAS + NET_DENSE)
#define NET_E_BIAS (NET_E + CANDIDATES * NET_DENSE)
#define NET_SIZE (NET_E_BIAS + CANDIDATES)

float candidate(int i) { return kSlopeWidth * float(i - CANDIDATES / 2); }
float leaky(float v) { return v > 0.0 ? v : 0.1 * v; }

// Size of a level of points, and the index of its first.
uvec2 level_size(uvec2 size, uint level) {
  for (uint l = 0u; l < level; ++l) size = (size + 1u) / 2u;
  return size;
}
uint level_start(uvec2 size, uint level) {
  uint start = 0u;
  for (uint l = 0u; l < level; ++l, size = (size + 1u) / 2u) start += size.x * size.y;
  return start;
}
