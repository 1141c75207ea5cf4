// SPDX-License-Identifier: LGPL-2.1-or-later
// A stroke of the scene: the ball around its balls, center and radius in meters; first ball, balls, id, -.
#define BRUSH_BOUND 0
#define BRUSH_BALLS 1
#define BRUSH_STRIDE 2
// Bits of what an id is: its stroke is still there; it fills; it is new, and covers others.
#define ID_KEPT 1
#define ID_FILLS 2
#define ID_FRESH 4
// What the select kernel keeps of a block: whether it has marks, and how many voxels around it had a color when they spread last.
#define MARKED_NONE 0
#define MARKED_NEW 1
#define MARKED_COUNT 2  // and that many
#define LIST_SPREADS 0x80000000u
// The state: for each pass of filling, and one more, the workgroups of its dispatch and the voxels of its front; then the same of
// the listed blocks.
#define FILL_PASSES 32
#define STATE_STRIDE 4
#define STATE_FRONT 3
#define STATE_BLOCKS 132  // STATE_STRIDE (FILL_PASSES + 1)
#define STATE_WORDS 136
#define FRONT_MAX 65536
#define FRONT_GROUP 64
// Sums over the voxels under the brush of a stroke that fills: R.rgb in steps, and their number.
#define SUM_STRIDE 4
#define SUM_COUNT 3
const float kSumSteps = 1024.0;
